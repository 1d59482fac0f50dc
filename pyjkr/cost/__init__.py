"""What accuracy costs in time: a scene run many ways through LIGGGHTS, its errors against the oracle, its steps and times.

Data flows scene -> `variants` -> `studies` -> `impacts` (LIGGGHTS) and `exact` (oracle) -> `measure` -> `results` -> `tables`,
`figures` -> `report`, `page`; `command` is the verb.
"""

from pyjkr.cost.measure import measure
from pyjkr.cost.results import Costs
from pyjkr.cost.studies import FULL, QUICK, Jobs, Setting

__all__ = ["FULL", "QUICK", "Costs", "Jobs", "Setting", "measure"]
