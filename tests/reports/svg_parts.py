"""What stands in a picture, for tests."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
from numpy.typing import NDArray

from reports.drawing.pictures import Picture


def elements(picture: Picture, kind: str) -> list[ElementTree.Element]:
    """The elements of a kind in their order."""
    found = ElementTree.fromstring(picture.svg()).iter(f"{{http://www.w3.org/2000/svg}}{kind}")
    return list(found)


def points_px(path: ElementTree.Element) -> NDArray[np.float64]:
    """The points (n, 2) of a path."""
    return np.array(re.findall(r"[\d.-]+", path.attrib["d"]), dtype=np.float64).reshape(-1, 2)
