"""Sessions: a client that listens nowhere, and requests that end."""

from __future__ import annotations

import json
import os
import re
import socket
import ssl
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, final

import msgpack
import zenoh

from ..errors import Corrupt, NoAnswer, NoSuchRun, OtherVersion, Refused, Unreachable
from .types import Manifest
from .wire import NAMESPACE, REFUSAL, VERSION, decode

if TYPE_CHECKING:
    from .run import Run

T = TypeVar("T")

#: The one user, whose password the secret of a run is.
SECRET_USER = "isola"
#: Files of a folder of certificates: whom to trust, one's own certificate, and the key to it.
CERTIFICATES = ("ca.crt", "tls.crt", "tls.key")
#: How long a client tries to connect, ms.
CONNECT_MS = 3000
#: A partner that has been silent for so long is gone, ms.
TRANSPORT_LEASE_MS = 5000
#: Pauses between attempts at a request, s: the first one, doubled up to the last one.
PAUSES = (0.05, 1.0)
#: Whoever is so much later than it wanted to be was stopped meanwhile, s.
STOPPED = 1.5
#: Why there is no answer on a connection that this program has closed itself.
CLOSED = "the connection was closed by this program"
#: How long to look for runs before there are none, s. Routes need a moment after connecting.
LOOK = 2.0


@dataclass(frozen=True)
class Answer:
    """One answer to a request."""

    key: str
    encoding: str
    payload: bytes


@dataclass(frozen=True)
class Answers:
    """All answers to a request."""

    answers: list[Answer]
    #: Why it was refused, if it was.
    refusal: str | None
    #: Whether time ran out or a partner disappeared before the last answer.
    cut_short: bool


def read(name: str, answer: Answer, convert: Callable[..., T], *more: object) -> T:
    """The message `name` in an answer, converted; :class:`Corrupt` if it does not hold what it should."""
    message = decode(answer.payload, answer.encoding, name)
    try:
        return convert(message, *more)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise Corrupt(f"`{name}` message: {type(error).__name__} {error}") from error


def endpoint_of(where: str | os.PathLike[str]) -> str:
    """The endpoint itself, or the one in the file `address` of a run directory."""
    directory = Path(where)
    if directory.is_dir():
        try:
            return (directory / "address").read_text("utf-8").strip()
        except FileNotFoundError:
            raise Unreachable(
                f"there is no file `address` in {directory}: its run is not on the bus; what it has stored isola_hbm.load reads"
            ) from None
    if isinstance(where, str) and re.match(r"[a-z][a-z0-9_-]*/.+:\d+", where):
        return where
    raise Unreachable(f"`{where}` is neither an endpoint like tcp/HOST:7447 nor a run directory")


def secret_of(where: str | os.PathLike[str], secret_file: str | os.PathLike[str] | None) -> str | None:
    """The secret of a run, if it has one that is known here: of a file, of the run directory, or of the environment."""
    own = Path(where) / "secret"
    if secret_file is not None:
        text = Path(secret_file).read_text("utf-8")
    elif own.is_file():
        text = own.read_text("utf-8")
    else:
        text = os.environ.get("ISOLA_SECRET", "")
    return text.strip().removeprefix(f"{SECRET_USER}:") or None


def certificates_of(
    where: str | os.PathLike[str], tls: str | os.PathLike[str] | None, endpoint: str
) -> dict[str, str] | None:
    """The files with certificates for an encrypted endpoint: of a folder, of the run directory, or of the environment."""
    if not endpoint.startswith("tls/"):
        if tls is not None:
            raise Unreachable(f"{endpoint}: certificates were named, but only connections to tls/HOST:PORT are encrypted")
        return None
    own = Path(where) / "tls"
    folder = tls or (own if own.is_dir() else os.environ.get("ISOLA_TLS"))
    if not folder:
        raise Unreachable(
            f"{endpoint}: an encrypted connection needs certificates: name a folder of them as tls (or in ISOLA_TLS), "
            "`isola cert` makes some"
        )
    files = {name: Path(folder).absolute() / name for name in CERTIFICATES}
    for file in files.values():
        with file.open("rb"):
            pass
    return {name: str(file) for name, file in files.items()}


def refusal_of(endpoint: str, files: Mapping[str, str]) -> str | None:
    """Why the certificates of both sides do not go together, as far as this side can know: an encrypted connection begun anew."""
    host, port = endpoint.removeprefix("tls/").rsplit(":", 1)
    host = host.strip("[]")
    authority, own, key = (files[name] for name in CERTIFICATES)
    try:
        context = ssl.create_default_context(cafile=authority)
        context.load_cert_chain(own, key)
        with (
            socket.create_connection((host, int(port)), timeout=1) as plain,
            context.wrap_socket(plain, server_hostname=host) as encrypted,
        ):
            # What the other side has to say against the certificate comes first.
            encrypted.recv(1)
    except ssl.SSLCertVerificationError as error:
        return f"the certificate that is shown there is not accepted here: {error.verify_message}"
    except ssl.SSLError as error:
        return f"this certificate is refused there: {error.reason or error}"
    except (OSError, ValueError):
        pass
    return None


def connect(
    where: str | os.PathLike[str],
    *,
    namespace: str = NAMESPACE,
    timeout: float = 10.0,
    secret_file: str | os.PathLike[str] | None = None,
    tls: str | os.PathLike[str] | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Bus:
    """Connects to a coordinator or a router.

    `where` is an endpoint (``tcp/127.0.0.1:7447``) or a run directory, whose file `address` holds one. `timeout` is how
    long requests are repeated, in s. `secret_file` holds the secret of the run: without it the file `secret` of the run
    directory does, or the variable ISOLA_SECRET of the environment. `tls` is a folder with the certificates of a viewer, for an
    endpoint that begins with ``tls/``: without it those that the run directory leads to, or in the folder that ISOLA_TLS names.
    `settings` are further settings of Zenoh by key, as for other passwords: ``{"transport/auth/usrpwd": {"user": "me",
    "password": "…"}}``.
    """
    endpoint = endpoint_of(where)
    secret = secret_of(where, secret_file)
    certificates = certificates_of(where, tls, endpoint)
    config = zenoh.Config()
    own: dict[str, Any] = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": CONNECT_MS,
        "connect/exit_on_failure": True,
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000},
        "listen/endpoints": [],
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "adminspace/enabled": False,
        "transport/link/tx/lease": TRANSPORT_LEASE_MS,
    }
    if secret is not None:
        own["transport/auth/usrpwd"] = {"user": SECRET_USER, "password": secret}
    if certificates is not None:
        authority, certificate, key = (certificates[name] for name in CERTIFICATES)
        own["transport/link/tls"] = {
            "enable_mtls": True,
            "root_ca_certificate": authority,
            "connect_certificate": certificate,
            "connect_private_key": key,
        }
    for key, value in {**own, **(settings or {})}.items():
        config.insert_json5(key, json.dumps(value))
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        if certificates is not None and (refusal := refusal_of(endpoint, certificates)) is not None:
            raise Unreachable(f"no encrypted connection to {endpoint}: {refusal}") from error
        raise Unreachable(
            f"no coordinator or router can be reached at {endpoint}; check host, port and firewall; "
            + (
                "another secret than the run's looks the same"
                if secret is not None
                else "not to have its secret looks the same: name a copy of the file `secret` in its directory as secret_file"
            )
        ) from error
    return Bus(session, namespace, timeout)


@final
class Bus:
    """A connection; use it in a `with` statement or close it. Closing ends every iterator of its runs, with
    :class:`NoAnswer`."""

    def __init__(self, session: zenoh.Session, namespace: str = NAMESPACE, timeout: float = 10.0) -> None:
        self.session = session
        self.namespace = namespace
        #: How long requests are repeated, s.
        self.timeout = timeout
        #: Ends requests under way, and refuses others.
        self._cancellation: zenoh.CancellationToken | None = None
        #: What is called before the session is closed.
        self._closing: set[Callable[[], None]] = set()

    def __enter__(self) -> Bus:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the session."""
        for wake in list(self._closing):
            wake()
        if not self.session.is_closed():
            self.session.close()

    def _cancellable(self, cancellation: zenoh.CancellationToken) -> Bus:
        """The same connection, with requests that this ends."""
        bus = Bus(self.session, self.namespace, self.timeout)
        bus._cancellation, bus._closing = cancellation, self._closing
        return bus

    def runs(self) -> list[Manifest]:
        """Manifests of all runs that speak this version of the messages, by name."""
        look, patience = Patience(min(LOOK, self.timeout)), Patience(self.timeout)
        for pause in pauses():
            answers = self.ask(f"{self.namespace}/v{VERSION}/*/run", patience).answers
            if answers:
                runs = (Manifest.read(decode(a.payload, a.encoding, "manifest")) for a in answers)
                return sorted({run.run: run for run in runs}.values(), key=lambda run: run.run)
            others = self._other_versions(patience)
            if others:
                raise OtherVersion(
                    f"no run speaks version {VERSION} of the messages, which this client reads; there are {others}: "
                    "install the client that belongs to them"
                )
            if not any(self.session.info.routers_zid()):
                look = Patience(min(LOOK, self.timeout))
                if patience.is_over():
                    raise NoAnswer(f"the connection is lost, and was not restored in {self.timeout:g} s")
            elif look.is_over():
                return []
            time.sleep(min(pause, patience.left()))
        raise AssertionError("pauses do not end")

    def _other_versions(self, patience: Patience) -> str:
        """Runs of other versions, in words."""
        found = []
        for answer in self.ask(f"{self.namespace}/*/*/run", patience).answers:
            version, run = answer.key.split("/")[-3:-1]
            if version == f"v{VERSION}":
                continue
            try:
                program = f", Isola {msgpack.unpackb(answer.payload)['program']}"
            except (ValueError, KeyError, TypeError, msgpack.UnpackException):
                program = ""
            found.append(f"`{run}` ({version}{program})")
        return ", ".join(sorted(found))

    def run(self, name: str | None = None) -> Run:
        """The run of this name, or the only one there is."""
        from .run import Run

        runs = self.runs()
        chosen = [run for run in runs if name is None or run.run == name]
        if len(chosen) == 1:
            return Run(self, chosen[0])
        if not runs:
            raise NoSuchRun(f"there is no run in `{self.namespace}`")
        there = "; ".join(f"`{run.run}` ({run.name}, {run.stage})" for run in runs)
        if name is None:
            raise NoSuchRun(f"there are several runs, choose one by its name: {there}")
        raise NoSuchRun(f"there is no run `{name}`; there are {there}")

    def ask(self, key: str, patience: Patience) -> Answers:
        """All answers to one request. None at all may mean that nobody is reachable at the moment."""
        # Zenoh calls it unstable: only requests that can be ended need it.
        more: dict[str, Any] = {} if self._cancellation is None else {"cancellation_token": self._cancellation}
        try:
            replies = self.session.get(
                key,
                target=zenoh.QueryTarget.ALL,
                consolidation=zenoh.ConsolidationMode.NONE,
                timeout=patience.left(),
                **more,
            )
        except zenoh.ZError as failure:
            if self.session.is_closed() or (self._cancellation is not None and self._cancellation.is_cancelled):
                raise NoAnswer(CLOSED) from failure
            raise
        answers, refusal, cut_short = [], None, False
        for reply in replies:
            if (sample := reply.ok) is not None:
                answers.append(Answer(str(sample.key_expr), str(sample.encoding), sample.payload.to_bytes()))
            elif (error := reply.err) is not None and str(error.encoding) == REFUSAL:
                refusal = error.payload.to_string()
            else:
                # Zenoh itself answers with an error when time is up or the partner is gone.
                cut_short = True
        return Answers(answers, refusal, cut_short)

    def fetch(self, key: str, timeout: float | None = None) -> Answer:
        """The one answer to a request, which is repeated until it comes."""
        patience = Patience(self.timeout if timeout is None else timeout)
        for pause in pauses():
            answers = self.ask(key, patience)
            if answers.answers:
                return answers.answers[0]
            if answers.refusal is not None:
                raise Refused(answers.refusal)
            if patience.is_over():
                raise NoAnswer(f"no answer to `{key}` in {patience.seconds:g} s")
            time.sleep(min(pause, patience.left()))
        raise AssertionError("pauses do not end")


class Patience:
    """Time to wait. Time for which this process was stopped does not count: it could not hear anybody."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.deadline = time.monotonic() + seconds

    def left(self) -> float:
        """Time left, s; a little at least."""
        return max(self.deadline - time.monotonic(), 0.1)

    def is_over(self) -> bool:
        """Whether it is over. Everything that waits ends at the deadline: whoever is later was stopped."""
        late = time.monotonic() - self.deadline
        if late > STOPPED:
            self.deadline = time.monotonic() + self.seconds
        return 0 < late <= STOPPED


def pauses() -> Iterator[float]:
    """Pauses between attempts, s."""
    pause, last = PAUSES
    while True:
        yield pause
        pause = min(2 * pause, last)
