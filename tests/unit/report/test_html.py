from html.parser import HTMLParser

import numpy as np

from regframe.report.html import card, describe
from support.results import image, ramp, result

VOID = {"img"}


class Strict(HTMLParser):
    """Fails on tags that are not closed in order."""

    def __init__(self):
        super().__init__()
        self.open, self.images, self.text = [], [], ""

    def handle_starttag(self, tag, attrs):
        if tag in VOID:
            self.images.append(dict(attrs))
        else:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def parsed(made):
    page = Strict()
    page.feed(card(made))
    page.close()
    return page


def test_the_card_is_whole_and_loads_nothing():
    page = parsed(result())

    assert page.open == []
    assert len(page.images) == 2
    assert all(one["src"].startswith("data:image/png;base64,") for one in page.images)


def test_notebooks_show_the_card():
    assert result()._repr_html_() == card(result())


def test_names_cannot_break_the_page():
    page = parsed(result(fixed=image(ramp((12, 16)), "<script>alert(1)</script>&.png")))

    assert page.open == []
    assert "&.png" in page.text


def test_the_card_of_a_large_image_stays_small():
    large = image(np.random.default_rng(1).integers(0, 256, (1200, 1600), dtype=np.uint8), "large.png")

    assert len(card(result(large, large, shift=(0, 0)))) < 1_000_000


def test_the_map_is_told_for_people():
    assert describe(result()) == "centre off by (2.00, -1.00) px, rotation 2.865 deg, scale 1.10000"


def test_the_map_of_medical_images_is_told_in_millimetres():
    one = image(ramp((6, 8, 10), np.float32), "volume", spacing=(1.0, 1.0, 2.0))

    told = describe(result(one, one, shift=(1, 2, 3)))

    assert told == "shift (1.00, 2.00, 3.00) mm, rotation 0.000 deg, scale 1.00000"
