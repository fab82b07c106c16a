"""For those who write components: images with known answers, and the checks every component passes."""
