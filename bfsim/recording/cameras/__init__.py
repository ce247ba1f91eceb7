"""Cameras as OpenCV and ROS describe them, and how their pictures are rectified."""
