"""Measured rebounds -> damping and surface energy: the inversion of Chen, Liu, Li 2019, section 3, on the model itself.

Data flows CSV file -> `measurements` -> `inversion` (`region`, on `collision`, from `table`) -> `caveats`, `report`;
`command` is the verb `pyjkr calibrate`.
"""

from pyjkr.calibrate.inversion import Calibration, Estimate, fit
from pyjkr.calibrate.measurements import Measurements, read
from pyjkr.calibrate.particle import CalibrationError, Particle

__all__ = ["Calibration", "CalibrationError", "Estimate", "Measurements", "Particle", "fit", "read"]
