"""What every component must hold about memory: it has none."""

import sys

from regframe.component import Component
from regframe.testing.claims import NotApplicable, require
from regframe.testing.observation import observe, same
from regframe.testing.worker import worker

Things = dict[str, tuple[int, int]]


def check_keeps_no_state(component: Component) -> None:
    """What was done before changes nothing, and no class attribute or global of its module changes."""
    before = _globals(component)
    first = observe(component, 1)
    observe(component, 2)
    again = observe(component, 1)
    after = _globals(component)
    changed = sorted(name for name in {*before, *after} if before.get(name) != after.get(name))
    require(
        not changed,
        f"Using it changes {', '.join(changed)}: global state, shared by every run and thread. "
        "Keep state in local variables; a metric's work of a level goes into `prepare`.",
    )
    require(
        same(first, again),
        "It gives something else after other inputs: it remembers them. Keep state in local variables.",
    )


def check_is_the_same_in_a_new_process(component: Component) -> None:
    """A process started anew gives the same bits, so work can be shared among processes."""
    here = observe(component, 1)
    answer = worker().ask(component, 1)
    if answer.unknown:
        message = f"a new process cannot import it ({answer.unknown}); put it into a module"
        raise NotApplicable(message)
    require(not answer.failed, f"In a new process it raises {answer.failed}.")
    require(
        answer.seen is not None and same(here, answer.seen),
        "A new process gives other values: it depends on what happened before in this one, or on chance. "
        "Keep state in local variables and draw only from the generator that is handed over.",
    )


CHECKS = (check_keeps_no_state, check_is_the_same_in_a_new_process)


def _globals(component: Component) -> Things:
    """Identity and length of every plain attribute of its class and of its module."""
    cls = type(component)
    places = {cls.__qualname__: vars(cls), cls.__module__: vars(sys.modules.get(cls.__module__, cls))}
    return {
        f"{place}.{name}": (id(value), _length(value))
        for place, things in places.items()
        for name, value in list(things.items())
        if not name.startswith(("__", "_abc"))
    }


def _length(value: object) -> int:
    return len(value) if isinstance(value, list | dict | set | bytearray) else 0
