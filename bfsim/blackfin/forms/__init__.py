"""The instruction table, grouped as the programming reference groups it; where two rows could be meant, the first counts."""

from bfsim.blackfin.forms import (
    arithmetic,
    conditions,
    control,
    immediates,
    loads,
    loads_dag,
    moves,
    pseudo,
    system,
)

TABLE = (
    *control.FORMS,
    *moves.FORMS,
    *immediates.FORMS,
    *conditions.FORMS,
    *arithmetic.FORMS,
    *loads.FORMS,
    *loads_dag.FORMS,
    *system.FORMS,
    *pseudo.FORMS,
)
