"""Encrypted connections: a viewer with its certificate reads, others are told why not."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest
from fake import free_port
from runs import MODELS, isola, program
from test_live import wait_for

import isola_hbm


def test_certificates(tmp_path: Path) -> None:
    made, foreign, run = tmp_path / "certificates", tmp_path / "foreign", tmp_path / "run"
    isola("cert", made)
    isola("cert", foreign)
    endpoint = f"tls/127.0.0.1:{free_port()}"
    study = MODELS / "nonlinear_damper" / "study.toml"
    served = ["--listen", endpoint, "--tls", made / "coordinator", "--workers", "1", "--stay"]
    process = subprocess.Popen(
        [program(), "sweep", study, "--amplitudes", "0.004", "--search", "none", "--out", run, *served],
        start_new_session=True,
    )
    try:
        wait_for("address", lambda: (run / "address").exists() or process.poll() is not None)
        secret = run / "secret"
        with isola_hbm.connect(endpoint, secret_file=secret, tls=made / "viewer") as bus:
            assert [branch.kind for branch in bus.run().follow()] == ["main"]
        # The folder of the run leads to the certificates of its coordinator.
        with isola_hbm.connect(run) as bus:
            assert bus.run().status().is_over
        for tls, expected in [
            (None, "name a folder of them as tls"),
            (foreign / "viewer", "the certificate that is shown there is not accepted here"),
        ]:
            with pytest.raises(isola_hbm.Unreachable, match=expected):
                isola_hbm.connect(endpoint, secret_file=secret, tls=tls)
        # The right authority, and a certificate of another one.
        (foreign / "viewer" / "ca.crt").write_bytes((made / "ca.crt").read_bytes())
        with pytest.raises(isola_hbm.Unreachable, match="this certificate is refused there"):
            isola_hbm.connect(endpoint, secret_file=secret, tls=foreign / "viewer")
        with pytest.raises(isola_hbm.Unreachable, match="only connections to tls/HOST:PORT are encrypted"):
            isola_hbm.connect("tcp/127.0.0.1:1", tls=made / "viewer")
        with pytest.raises(FileNotFoundError):
            isola_hbm.connect(endpoint, tls=tmp_path)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
        process.wait(30)
