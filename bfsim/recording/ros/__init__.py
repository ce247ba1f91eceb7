"""Pictures from bags of ROS, through the optional package rosbags."""
