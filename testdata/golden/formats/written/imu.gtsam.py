# Test: "IMU" # 1
# Source: two lines
# gyro_x: its bias is not a random walk. The one used is the best for an outage of 30 s: after it a filter's standard deviation is 1.0 times its error, after ten times as long 1.2 times.
# gyro_y: its bias is not a random walk. The one used is the best for an outage of 30 s: after it a filter's standard deviation is 1.0 times its error, after ten times as long 1.2 times.
# gyro_z: its bias is not a random walk. The one used is the best for an outage of 30 s: after it a filter's standard deviation is 1.0 times its error, after ten times as long 1.1 times.
# Squares of continuous-time densities of the axes x, y, z, in the axes of the samples.
# biasAccOmegaInit counts as white noise of each sample; the uncertainty of the first bias belongs to its prior.
import gtsam
import numpy as np

params = gtsam.PreintegrationCombinedParams.MakeSharedU(9.80665)  # z up; MakeSharedD: down
params.setAccelerometerCovariance(np.diag([1.0e-6, 1.0e-6, 1.0e-6]))  # (m/s²)²/Hz
params.setGyroscopeCovariance(np.diag([7.61543549e-9, 7.61543549e-9, 3.0461742e-8]))  # (rad/s)²/Hz
params.setBiasAccCovariance(np.diag([1.0e-8, 1.0e-8, 1.0e-8]))  # (m/s³)²/Hz
params.setBiasOmegaCovariance(np.diag([1.51228886e-11, 1.51228886e-11, 1.20125374e-11]))  # (rad/s²)²/Hz
if hasattr(params, "setBiasAccOmegaInit"):  # up to GTSAM 4.2
    params.setBiasAccOmegaInit(np.zeros((6, 6)))
params.setIntegrationCovariance(1e-8 * np.eye(3))  # not of the sensor
