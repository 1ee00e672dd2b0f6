"""Pictures: the supplement's figures, error maps, and cost against error, all from the tables."""

from shadefit.figures.gallery import PICTURES as PICTURES
from shadefit.figures.gallery import Picture as Picture
from shadefit.figures.gallery import run as run
from shadefit.figures.style import render as render
