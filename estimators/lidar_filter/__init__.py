"""A tumbling unknown target seen by a LIDAR: registration of scans, and filters of the target's motion.

After Song, Li and Ma, "LIDAR-Based Relative Position and Attitude Filtering for Unknown Targets", Journal of System Simulation
29(5), 2017, 1103-1111: as printed, mended, and with states that suit a target of which nothing is known.
"""
