"""SimpleITK as a second engine, and the cross-check of both."""
