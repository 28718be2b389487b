"""Functional voxels: the tangent plane of an implicit function at every node, its algebra, and its images."""

from rfm.geometry.voxels.algebra import complement, intersection, union
from rfm.geometry.voxels.images import read_images, write_images
from rfm.geometry.voxels.model import VoxelModel, voxels
from rfm.geometry.voxels.reconstruction import value_at, zero_points

__all__ = [
    "VoxelModel",
    "complement",
    "intersection",
    "read_images",
    "union",
    "value_at",
    "voxels",
    "write_images",
    "zero_points",
]
