"""The page of a live run, on the loopback interface alone: what is seen, how far, and how well it goes."""

from __future__ import annotations

import json
import time
from collections import deque
from collections.abc import Callable
from dataclasses import asdict
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Condition, Lock, Thread
from typing import Any
from urllib.parse import urlsplit

from vista.alignment import Alignment
from vista.chain import Chain
from vista.errors import InputError
from vista.live.loop import Seen, Totals
from vista.obstacle_line import obstacle_line
from vista.report.overlay import Overlay
from vista.report.page import fill_template
from vista.result_folder import encoded

HOST = "127.0.0.1"
NAMES = ("127.0.0.1", "localhost")  # a page of elsewhere that resolves its own name to us is refused
LEAST_S = 0.1  # between two states: people read no faster
ALIVE_S = 0.5  # a state is sent again after so long, so that the page sees how old it is
RATE_FRAMES = 60
POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'unsafe-inline'",
        "style-src 'unsafe-inline'",
        "img-src 'self' data:",
        "connect-src 'self'",
    )
)


class LivePage:
    """A listener of the loop, and a server of the newest frame. Pictures are drawn when one is asked for."""

    def __init__(self, port: int, chain: Chain, totals: Totals, facts: Callable[[], dict[str, Any]]) -> None:
        """port: 0 takes a free one; facts: what else the state tells. Raises InputError for a port in use."""
        self._overlay = Overlay(
            chain.sequence.name, chain.engine.parameters.num_disparities, chain.rectifier.calibration
        )
        self._totals, self._facts = totals, facts
        self._camera = asdict(chain.rectifier.calibration)
        self._changed, self._drawing = Condition(), Lock()
        self._seen: Seen | None = None
        self._done_s: deque[float] = deque(maxlen=RATE_FRAMES)
        self._over = False
        page = fill_template("live.html.j2", "vista.live", name=chain.sequence.name).encode()
        try:
            self._server = ThreadingHTTPServer((HOST, port), handler_of(self, page))
        except (OSError, OverflowError) as error:
            reason = (getattr(error, "strerror", None) or "no such port").lower()
            raise InputError(f"--page {port}", reason) from None
        self._server.daemon_threads = True
        self._thread = Thread(target=self._server.serve_forever, args=(0.1,), name="page", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self._server.server_address[1]}/"

    def take(self, seen: Seen) -> None:
        seen.step.keep()  # a browser may ask for its picture while the next frame is worked on
        with self._changed:
            self._seen = seen
            self._done_s.append(time.monotonic())
            self._changed.notify_all()

    def close(self) -> None:
        with self._changed:
            self._over = True
            self._changed.notify_all()
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def wait(self, shown_ns: int | None) -> bool:
        """Waits until there is another frame than this one, or it is time to say that there is none. False:
        the run is over."""
        with self._changed:
            self._changed.wait_for(lambda: self._over or self.newest_ns() != shown_ns, ALIVE_S)
            return not self._over

    def state(self) -> str:
        """What the page shows, as JSON."""
        with self._changed:
            seen, done_s = self._seen, tuple(self._done_s)
        totals, latency = self._totals, self._totals.latency
        state: dict[str, Any] = {
            "processed": totals.processed,
            "dropped": totals.dropped,
            "duplicates": totals.duplicates,
            "restarts": totals.restarts,
            "latency_ms": {
                "last": latency.last_ms,
                "median": latency.percentile_ms(50.0),
                "p99": latency.percentile_ms(99.0),
            },
            "rate_hz": rate_hz(done_s, time.monotonic()),
            "camera": self._camera,
            "frame": None,
        }
        if seen is not None:
            state |= {
                "frame": seen.record.index,
                "age_ms": 1e-6 * (time.monotonic_ns() - seen.exposed_ns),
                "stage_ms": seen.record.stage_ms,
                "reasons": [finding.text for finding in seen.record.health.findings],
                "alignment": alignment_facts(seen.record.alignment),
            }
        text = json.dumps(state | self._facts())
        return text if seen is None else f'{text[:-1]}, "line": {obstacle_line(seen.record)}}}'

    def picture(self, whole: bool) -> bytes | None:
        """The newest frame as JPEG; whole: with disparities and regions. None: there is none yet."""
        seen = self._seen
        if seen is None:
            return None
        step, result = seen.step, seen.step.result
        with self._drawing:
            if whole:
                drawn = self._overlay.draw(step.frame, result, seen.record.health)
            else:
                drawn = self._overlay.obstacles(step.frame, result, seen.record.warning)
        return encoded(drawn)

    def newest_ns(self) -> int | None:
        """The time at which the newest frame was exposed."""
        return None if self._seen is None else self._seen.exposed_ns


def alignment_facts(alignment: Alignment | None) -> dict[str, Any] | None:
    """The turn of the right camera that is corrected; None: it is not looked at."""
    if alignment is None:
        return None
    turn = alignment.correction
    return {
        "state": alignment.state,
        "pitch_deg": turn.pitch_deg,
        "roll_deg": turn.roll_deg,
        "row_error_px": alignment.row_error_px,
    }


def rate_hz(done_s: tuple[float, ...], now_s: float) -> float:
    """The rate of the last frames; it falls while none comes."""
    return (len(done_s) - 1) / (now_s - done_s[0]) if len(done_s) > 1 and now_s > done_s[0] else 0.0


def handler_of(live: LivePage, page: bytes) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        server_version, sys_version = "VISTA", ""
        timeout = 10.0  # of a client that does not read

        def do_GET(self) -> None:
            url = urlsplit(self.path)
            host = self.headers.get("Host", "").rpartition(":")
            if (host[0] or host[2]) not in NAMES:
                self.send_error(HTTPStatus.FORBIDDEN)
            elif url.path == "/":
                self._send("text/html; charset=utf-8", page)
            elif url.path == "/state":
                self._send("application/json", live.state().encode())
            elif url.path == "/states":
                self._stream()
            elif url.path == "/picture.jpg":
                picture = live.picture(url.query.startswith("whole"))
                if picture is None:
                    self.send_error(HTTPStatus.NOT_FOUND)
                else:
                    self._send("image/jpeg", picture)
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def _stream(self) -> None:
            """Server-sent events: a state for each frame, though not more than a page can show."""
            self._headers("text/event-stream")
            shown, going = None, True
            while going:
                state = live.state()
                shown = live.newest_ns()
                self.wfile.write(b"data: " + state.encode() + b"\n\n")
                time.sleep(LEAST_S)
                going = live.wait(shown)

        def _send(self, kind: str, body: bytes) -> None:
            self._headers(kind, len(body))
            self.wfile.write(body)

        def _headers(self, kind: str, length: int | None = None) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", kind)
            if length is not None:
                self.send_header("Content-Length", str(length))
            self.send_header("Cache-Control", "no-store")
            self.send_header("Content-Security-Policy", POLICY)
            self.send_header("X-Content-Type-Options", "nosniff")
            self.end_headers()

        def handle(self) -> None:
            try:
                super().handle()
            except (ConnectionError, TimeoutError):  # the browser has gone
                self.close_connection = True

        def log_message(self, *_: Any) -> None:
            """Nothing: stderr is for what the pilot should know."""

    return Handler
