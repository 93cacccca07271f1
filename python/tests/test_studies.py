"""Studies of models whose known answers need no sweep of their own elsewhere, against closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from runs import MODELS, isola

import isola_hbm


def computed(name: str, folder: Path) -> isola_hbm.StoredRun:
    isola("sweep", MODELS / name, "--out", folder / name, "--verify", "none")
    return isola_hbm.load(folder / name)


def peaks(run: isola_hbm.StoredRun) -> dict[float, tuple[float, float]]:
    """Largest amplitude of the main branch, and where, by forcing amplitude."""
    main = run.summary[run.summary["kind"] == "main"]
    return {row["amplitude"]: (row["amplitude_max"], row["omega_at_max"]) for _, row in main.iterrows()}


def test_friction_takes_what_the_force_gives(tmp_path: Path) -> None:
    run = computed("friction_mass", tmp_path)
    assert set(run.summary["kind"]) == {"main"}
    sliding = []
    for forcing, (_, omega) in peaks(run).items():
        branch = run[forcing, "main"]
        at = branch.isel(point=branch.attrs["peak"])
        # Σ_k X_k exp(i k φ), and its derivative by φ.
        phase = np.linspace(0, 2 * np.pi, 20_001)
        k = np.arange(at.sizes["harmonic"])
        waves = np.exp(1j * np.outer(k, phase))
        x, v = (np.real(at["displacement"].values * factor @ waves) for factor in (1, 1j * k * omega))
        # M is the identity, the modes are in phase and in opposition, of 1 and sqrt(3) rad/s; the force is on the first.
        force = forcing / np.sqrt(2) * np.cos(phase)
        shapes = np.array([[1, 1], [1, -1]]) / np.sqrt(2)
        rates = shapes @ v
        seconds = np.full(20_000, 2 * np.pi / omega / 20_000)

        def over_a_period(power, seconds=seconds):
            return float(power[:-1] @ seconds)

        given = over_a_period(force * (v[0] + v[1]))
        damped = over_a_period(0.02 * rates[0] ** 2 + 0.02 * np.sqrt(3) * rates[1] ** 2)
        rubbed = over_a_period(0.02 * np.tanh(v[1] / 0.01) * v[1])
        # A loop of the height of twice the limit, where the motion turns back twice a period.
        assert np.count_nonzero(np.diff(np.sign(v[0][:-1]))) == 2
        size = (x[0].max() - x[0].min()) / 2
        loop = 4 * 0.1 * max(size - 0.1, 0)
        sliding.append(size > 0.1)
        assert damped + rubbed + loop == pytest.approx(given, rel=1e-4)
    assert sliding == [False, True, True, True]
    # From between the frequencies with x1 held by another 1 N/m to mode 1 without it.
    frequencies = [omega for _, omega in peaks(run).values()]
    assert frequencies == sorted(frequencies, reverse=True)
    assert frequencies[-1] == pytest.approx(1, rel=3e-3)


def test_masses_that_hit_each_other(tmp_path: Path) -> None:
    run = computed("two_masses_stop", tmp_path)
    found = peaks(run)
    # Without contact: one mass of 3 N/m in q = (x1 − x2)/√2.
    assert found[0.002][0] == pytest.approx(0.002 / (2 * 0.005 * np.sqrt(1 - 0.005**2) * 3) / np.sqrt(2), rel=1e-4)
    for forcing in (0.005, 0.02):
        size, omega = found[forcing]
        exact = np.sqrt(3) * np.pi / (np.pi - np.arccos(0.05 / size))
        # Truncated impacts are too soft: of first order in 1/H.
        assert 0.95 < omega / exact < 1


def free(t, x, v, ratio=0.005):
    """Free motion of x″ + 2 ratio x′ + x = 0 from (x, v) after a time t."""
    damped = np.sqrt(1 - ratio**2)
    sine, cosine, decay = np.sin(damped * t), np.cos(damped * t), np.exp(-ratio * t)
    return decay * (x * cosine + (v + ratio * x) / damped * sine), decay * (v * cosine - (x + ratio * v) / damped * sine)


def impacts(forcing: float) -> tuple[float, float] | None:
    """Range of frequencies of elastic orbits with one impact a period, from closed forms (`solver/tests/solver/isolas.rs`)."""
    omega = np.arange(1.0005, 1.9999, 1e-5)
    period = 2 * np.pi / omega
    (e11, e21), (e12, e22) = free(period, 1, 0), free(period, 0, 1)
    determinant = (1 - e11) * (e22 - 1) + e12 * e21
    y = (-e12 * (e22 - 1) + e12 * (1 + e22)) / determinant
    z = (-(1 - e11) * (1 + e22) - e21 * e12) / determinant
    steady = 1 / np.hypot(1 - (3 * omega) ** 2, 0.01 * 3 * omega)
    a, b, c = y**2 + (z / 3 / omega) ** 2, -2 * y, 1 - (forcing * steady) ** 2
    there = omega[(b**2 >= 4 * a * c) & (-b + np.sqrt(np.maximum(b**2 - 4 * a * c, 0)) > 0)]
    return (there.min(), there.max()) if len(there) else None


def test_impacts_every_third_period_of_the_force(tmp_path: Path) -> None:
    run = computed("impact_subharmonic", tmp_path)
    assert impacts(0.1068) is None
    assert impacts(0.1069) is not None
    for forcing in (0.1, 0.2, 0.5):
        level = run.summary[(run.summary["amplitude"] == forcing) & (run.summary["kind"] != "main")]
        exact = impacts(forcing)
        if exact is None:
            assert level.empty
            continue
        assert list(level["kind"]) == ["isola"]
        # Of first order in 1/H: the isola is a little narrower.
        assert exact[0] < level["omega_min"].item() < 1.01 * exact[0]
        assert 0.95 * exact[1] < level["omega_max"].item() < exact[1]


def test_a_beam_that_reaches_its_stop(tmp_path: Path) -> None:
    run = computed("cantilever_stop", tmp_path)
    found = peaks(run)
    # Euler's beam under a force at its tip; all modes have the same deflection there.
    stiffness, mass = 210e9 * 0.02 * 0.01**3 / 12, 7800 * 0.02 * 0.01
    beta = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349])
    natural = beta**2 * np.sqrt(stiffness / mass)
    omega = np.linspace(52, 53, 20_001)
    tip = np.abs(sum(4 / mass / (w**2 - omega**2 + 2j * 0.005 * w * omega) for w in natural))
    assert found[0.01][0] == pytest.approx(0.01 * tip.max(), rel=1e-3)
    assert found[0.01][1] == pytest.approx(omega[tip.argmax()], rel=1e-4)
    # It touches from A = 0.0108 on, and is stiffer the further it touches.
    touching = run.summary.set_index("amplitude")["contact_omega_min"].notna()
    assert [bool(touching[forcing]) for forcing in (0.01, 0.012, 0.015)] == [False, True, True]
    frequencies = [at for _, at in found.values()]
    assert frequencies == sorted(frequencies) and frequencies[1] > 1.01 * frequencies[0]
