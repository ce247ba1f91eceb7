"""The instruction table, grouped as in the programming reference; if two rows fit, the first counts."""

from bfsim.blackfin.instructions.forms import (
    accumulators,
    arithmetic,
    bitfields,
    conditions,
    control,
    immediates,
    loads,
    loads_dag,
    moves,
    multiplications,
    pseudo,
    shifts,
    sums,
    system,
    video,
)

TABLE = (
    *control.FORMS,
    *moves.FORMS,
    *immediates.FORMS,
    *conditions.FORMS,
    *arithmetic.FORMS,
    *loads.FORMS,
    *loads_dag.FORMS,
    *multiplications.FORMS,
    *sums.FORMS,
    *accumulators.FORMS,
    *video.FORMS,
    *shifts.FORMS,
    *bitfields.FORMS,
    *system.FORMS,
    *pseudo.FORMS,
)
