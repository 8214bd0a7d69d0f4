"""Private parts of the pybullet adapter: geometry of the contact, the world, its loop, and what is made of its samples."""

from harness.engines.pybullet import quiet as quiet
