//! Messages of ROS 1 and ROS 2 that are read: sensor_msgs/Imu, sensor_msgs/NavSatFix, geometry_msgs/TwistStamped, nav_msgs/Odometry.
