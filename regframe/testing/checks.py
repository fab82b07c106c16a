"""The conformance suite: what regframe's own components hold, and what yours must hold too.

In a test file of a plugin these two lines run every check that fits, one test each::

    from regframe.testing import conformance

    test_conformance = conformance("metric", "my-metric")

Elsewhere `verify` runs the same checks and returns what they say, and so does ``regframe check``.
"""

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pickle import dumps, loads
from time import perf_counter
from typing import Any, Literal, overload

from regframe.catalog import FILTERS, INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS, of_kind
from regframe.component import Component
from regframe.errors import PresetError
from regframe.filters.base import Filter
from regframe.interpolators.base import Interpolator
from regframe.metrics.base import Metric
from regframe.optimizers.base import Optimizer
from regframe.registry import Registry
from regframe.testing import (
    filter_checks,
    interpolator_checks,
    metric_checks,
    optimizer_checks,
    state_checks,
    transform_checks,
)
from regframe.testing.claims import NotApplicable, require
from regframe.transforms.base import Transform

__all__ = ["Check", "NotApplicable", "Verdict", "checks_for", "conformance", "verify"]


@dataclass(frozen=True)
class Check:
    """One claim about one component.

    Parameters
    ----------
    name : str
        The claim in a few words.
    about : str
        The claim in a sentence.
    component : Component
    function : callable
        Raises AssertionError, naming the fault, or NotApplicable.
    """

    name: str
    about: str
    component: Component
    function: Callable[[Any], None]

    def run(self) -> None:
        """Raise AssertionError where the claim does not hold."""
        self.function(self.component)


@dataclass(frozen=True)
class Verdict:
    """What came of a check.

    Parameters
    ----------
    name, about : str
        The claim in a few words, and in a sentence.
    outcome : str
        "holds", "fails" or "does not apply".
    message : str
        The fault, or why the check does not apply.
    seconds : float
        What the check took.
    """

    name: str
    about: str
    outcome: Literal["holds", "fails", "does not apply"]
    message: str = ""
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether nothing was found wrong."""
        return self.outcome != "fails"


def check_survives_pickling(component: Component) -> None:
    """A pickled component comes back equal, so it can be sent to another process."""
    try:
        copy = loads(dumps(component))
    except Exception as error:
        # pickle reports in many ways; each of them means the same to a user of several processes.
        message = f"It cannot be pickled: {type(error).__name__}: {error}. Define the class in a module."
        raise AssertionError(message) from error
    require(copy == component, f"Pickling changes it: {component!r} becomes {copy!r}.")


def check_survives_a_preset(component: Component) -> None:
    """Written into a preset and read again, a component is equal to itself."""
    table = json.loads(json.dumps(component.model_dump(mode="json")))
    again = type(component).model_validate(table)
    require(
        again == component,
        f"Its options written as JSON give another component: {again!r} for {component!r}.",
    )
    registry = _registry(component)
    try:
        registry.name_of(component)
    except PresetError:
        return  # a class under development need not have a name yet
    rebuilt = registry.build(json.loads(json.dumps(registry.dump(component))))
    require(rebuilt == component, f"Its table in a preset builds another one: {rebuilt!r} for {component!r}.")


def check_is_frozen_and_closed(component: Component) -> None:
    """Nothing on a component changes, and a misspelt option is refused."""
    settings = type(component).model_config
    require(
        settings.get("frozen") is True,
        "Fields can be set after it is built. Leave `frozen` in model_config alone.",
    )
    require(
        settings.get("extra") == "forbid", 'Unknown options pass. Leave extra="forbid" in model_config alone.'
    )
    require(
        not component.__pydantic_private__,
        "It has private attributes. Keep state in local variables of a run.",
    )


def check_describes_its_options(component: Component) -> None:
    """Each option says what it is for."""
    bare = [
        name for name, field in type(component).model_fields.items() if not (field.description or "").strip()
    ]
    require(not bare, f"Options without a description: {', '.join(bare)}. Write Field(..., description=...).")


def check_says_what_it_is(component: Component) -> None:
    """The class has a docstring whose first sentence ends in the first paragraph."""
    text = (type(component).__doc__ or "").strip()
    inherited = any(text == (base.__doc__ or "").strip() for base in type(component).__mro__[1:])
    require(
        bool(text) and not inherited, "The class has no docstring of its own. Say in a sentence what it is."
    )
    opening = " ".join(text.split("\n\n")[0].split())
    require(
        bool(re.search(r"[.:;]$", opening)),
        f"The docstring does not open with a whole sentence: {opening!r}.",
    )


def check_cites_its_source(component: Component) -> None:
    """The class docstring says where the method comes from: a publication with its year, or ITK's class."""
    text = type(component).__doc__ or ""
    require(
        bool(re.search(r"\b(1[89]|20)\d\d\b|\bitk::\w+", text)),
        "The docstring cites nothing. Name author and year of the method's source, or its `itk::` class.",
    )


COMMON = (
    check_survives_pickling,
    check_survives_a_preset,
    check_is_frozen_and_closed,
    check_describes_its_options,
    check_says_what_it_is,
    *state_checks.CHECKS,
)

KINDS: tuple[tuple[type[Component], Registry[Any], tuple[Callable[[Any], None], ...]], ...] = (
    (Metric, METRICS, (check_cites_its_source, *metric_checks.CHECKS)),
    (Transform, TRANSFORMS, transform_checks.CHECKS),
    (Interpolator, INTERPOLATORS, interpolator_checks.CHECKS),
    (Optimizer, OPTIMIZERS, (check_cites_its_source, *optimizer_checks.CHECKS)),
    (Filter, FILTERS, filter_checks.CHECKS),
)


def checks_for(component: Component) -> list[Check]:
    """Every check that a component of its kind must pass.

    Examples
    --------
    >>> from regframe.transforms.rigid import Rigid
    >>> [check.name for check in checks_for(Rigid())][:2]
    ['survives pickling', 'survives a preset']
    """
    functions = (*COMMON, *_kind(component)[2])
    return [
        Check(
            function.__name__.removeprefix("check_").replace("_", " "),
            (function.__doc__ or "").strip(),
            component,
            function,
        )
        for function in functions
    ]


def verify(component: Component) -> list[Verdict]:
    """Run every check and tell what each of them says.

    Examples
    --------
    >>> from regframe.transforms.rigid import Rigid
    >>> [verdict for verdict in verify(Rigid()) if not verdict.passed]
    []
    """
    return [_judge(check) for check in checks_for(component)]


@overload
def conformance(*components: Component) -> Callable[..., None]: ...


@overload
def conformance(kind: str, /, *names: str) -> Callable[..., None]: ...


def conformance(*components: Component | str) -> Callable[..., None]:
    """A pytest test function that runs every check of some components, each as a test of its own.

    Checks that do not apply are skipped with their reason. Needs pytest.

    Parameters
    ----------
    components : Component
        What to check, with the options to check it with; or, as on the command line, a kind and names:
        the components registered under them, with their defaults.

    Raises
    ------
    PresetError
        No such kind or name, or the component cannot be built.

    Examples
    --------
    >>> from regframe.transforms.rigid import Rigid
    >>> test_rigid = conformance(Rigid())
    >>> test_by_name = conformance("transform", "rigid", "affine")
    """
    import pytest

    built = _built([part for part in components if isinstance(part, str)])
    built += [part for part in components if isinstance(part, Component)]
    found = [check for component in built for check in checks_for(component)]

    @pytest.mark.parametrize("check", found, ids=_identity)
    def test_conformance(check: Check) -> None:
        try:
            check.run()
        except NotApplicable as reason:
            pytest.skip(f"does not apply: {reason}")

    return test_conformance


def _built(words: Sequence[str]) -> list[Component]:
    """The components that a kind and names stand for."""
    if not words:
        return []
    registry = of_kind(words[0])
    built: list[Component] = [registry.build(name) for name in words[1:]]
    return built


def _judge(check: Check) -> Verdict:
    began = perf_counter()
    outcome, message = _outcome(check)
    return Verdict(check.name, check.about, outcome, message, perf_counter() - began)


def _outcome(check: Check) -> tuple[Literal["holds", "fails", "does not apply"], str]:
    try:
        check.run()
    except NotApplicable as reason:
        return "does not apply", str(reason)
    except AssertionError as fault:
        return "fails", str(fault)
    except Exception as error:  # a check meets code that nobody has tried; its failure is a verdict too
        return "fails", f"raises {type(error).__name__}: {error}"
    return "holds", ""


def _identity(check: Check) -> str:
    options = ",".join(
        f"{name}={getattr(check.component, name)}" for name in check.component.model_fields_set
    )
    return f"{type(check.component).__name__}({options})-{check.name}"


def _kind(component: Component) -> tuple[type[Component], Registry[Any], Sequence[Callable[[Any], None]]]:
    for kind in KINDS:
        if isinstance(component, kind[0]):
            return kind
    known = ", ".join(base.__name__ for base, _, _ in KINDS)
    message = f"there are no checks for a {type(component).__name__}. Derive it from one of {known}."
    raise PresetError(message)


def _registry(component: Component) -> Registry[Any]:
    return _kind(component)[1]
