"""What else could have taken the robot's times: other readings of the thesis, and other programs."""
