"""Outcomes in words, the same ones that the program prints."""

from __future__ import annotations

from typing import Any

from .wire import variant

_STOPS = {
    "start": "linear range",
    "rest": "forcing grown from zero",
    "closed": "closed",
    "frequency_bound": "frequency bound",
    "amplitude_bound": "amplitude bound",
    "point_budget": "point budget used up",
    "reversed": "turned back along itself",
    "joined": "known branch",
    "branching": "branch point",
    "forcing_bound": "forcing bound",
    "cancelled": "cancelled",
}
_FAILURES = {
    "diverged": "the iteration diverged",
    "out_of_reach": "the forcing amplitude is not reached by continuation in the amplitude",
    "singular": "the Jacobian is singular",
}
_UNFOLLOWED = {
    "unsupported": 'a law has no second derivatives; contact has them with harmonics.quadrature = "arcs"',
    "elsewhere": "the nearest one is one of another response",
}
_LEFT_OUT = {
    "not_listed": "not in the list of modes",
    "rigid_body": "rigid body",
    "overdamped": "it does not oscillate",
    "out_of_range": "its resonance is out of reach of the frequency range",
    "too_many": "8 modes are followed already",
}
_FAR = "what converged lies on a known branch, far from the prediction (relative distance {:.2f} or more)"


def failure(value: Any) -> str:
    """Why a point could not be computed."""
    name, content = variant(value)
    if name == "not_converged":
        # No leading zeros in the exponent, as Rust prints it.
        mantissa, e, exponent = f"{content['residual']:.1e}".partition("e")
        residual = f"{mantissa}e{int(exponent)}" if e else mantissa
        return f"no convergence in {content['iterations']} iterations (scaled residual {residual})"
    return _FAILURES.get(name, name)


def stop(value: Any) -> str:
    """Why a walk along a curve ended."""
    name, content = variant(value)
    if name != "stalled":
        return _STOPS.get(name, name)
    name, content = variant(content)
    reasons = {
        "orientation": "the curve changes its orientation",
        "distance": "the response changes too much within a step",
    }
    if name == "newton":
        reasons[name] = failure(content)
    elif name == "angle":
        reasons[name] = f"the point lies off the tangent (cosine {content:.2f})"
    return f"stalled at the smallest step: {reasons.get(name, name)}"


def outcome(value: Any) -> str:
    """How a curve begins and ends."""
    name, content = variant(value)
    if name == "open":
        first, last = content
        return f"open: {stop(first)} to {stop(last)}"
    return name


def left_out(value: Any) -> str:
    """Why the backbone of a mode is not followed."""
    name, content = variant(value)
    if name == "not_started":
        return f"its backbone does not start: {content}"
    return _LEFT_OUT.get(name, name)


def branch_name(value: Any) -> str:
    """``main``, ``main 2``, ``isola 1``, ``isola 2``, ``cut 1``, …"""
    name, content = variant(value)
    return name if content is None else f"{name} {content + 1}"


def seed_outcome(value: Any) -> str:
    """What became of a task."""
    name, content = variant(value)
    if name == "found":
        return branch_name(content)
    if name == "passing":
        return f"{branch_name(content[0])} passes by (relative distance {content[1]:.2f})"
    if name == "not_landed":
        name, content = variant(content)
        if name == "far":
            return _FAR.format(content)
        if name == "shorter":
            return "every motion that converged repeats itself after fewer periods of the force"
        return f"nothing converged: {failure(content)}"
    if name == "not_traced":
        return f"landed, but no branch starts there: {failure(content)}"
    if name == "out_of_bounds":
        return "outside the frequency or amplitude bounds"
    if name == "no_fold":
        return "no fold was met"
    if name == "landed":
        return "1 forced response" if content == 1 else f"{content} forced responses"
    if name == "verified":
        return "1 point verified" if content == 1 else f"{content} points verified"
    if name == "disturbed":
        return f"{content} pushes marched"
    if name == "marched":
        return f"{content} periods marched"
    if name == "on_curve":
        return f"curve {content + 1}"
    if name == "not_followed":
        reason, _ = variant(content)
        return f"no curve starts there: {_UNFOLLOWED.get(reason) or failure(content)}"
    return name
