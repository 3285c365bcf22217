"""Who may talk to the studio: this machine, and those who were given the token.

A page from elsewhere must neither see the camera's performer nor drive the server. So requests
must name a host this server was started for (a name that was rebound to it is refused), must not
come from another origin, and off the loopback must bring the token.
"""

from __future__ import annotations

import hmac
from collections.abc import Mapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

LOOPBACK = frozenset(("127.0.0.1", "localhost", "::1"))
COOKIE = "mien"
HEADERS = {
    "content-security-policy": "default-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self' blob:; media-src 'self' blob:; style-src 'self' 'unsafe-inline'; "
    "frame-ancestors 'none'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
}


@dataclass(frozen=True, slots=True)
class Rules:
    """What is asked of a request."""

    hosts: frozenset[str]
    """Names under which this server may be called."""
    token: str = ""
    """What must be brought; empty: nothing."""

    def refusal(self, scope: Scope) -> str:
        """Why a request is refused, or nothing."""
        headers = {
            name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]
        }
        host = _host(headers.get("host", ""))
        if host not in self.hosts:
            return "this server does not go by that name"
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc != headers.get("host"):
            return "requests from other pages are refused"
        if self.token and not self._known(scope, headers):
            return "the token is missing: use the address that 'mien studio' printed"
        return ""

    def _known(self, scope: Scope, headers: Mapping[str, str]) -> bool:
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
        except CookieError:
            cookie = None
        brought = query.get("token", [cookie.value if cookie else ""])[0]
        return hmac.compare_digest(brought.encode(), self.token.encode())


class Guard:
    """Middleware that asks the rules before anything else happens."""

    def __init__(self, app: ASGIApp, rules: Rules) -> None:
        self._app, self._rules = app, rules

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        refusal = self._rules.refusal(scope)
        if not refusal:
            await self._app(scope, receive, self._dressed(scope, send))
        elif scope["type"] == "http":
            await PlainTextResponse(f"{refusal}\n", 403)(scope, receive, send)
        else:
            await receive()
            await send({"type": "websocket.close", "code": 4403, "reason": refusal})

    def _dressed(self, scope: Scope, send: Send) -> Send:
        async def dressed(message: dict[str, object]) -> None:
            if message["type"] == "http.response.start":
                headers = list(message.get("headers") or [])  # type: ignore[call-overload]
                headers += [(name.encode(), value.encode()) for name, value in HEADERS.items()]
                if self._rules.token:
                    cookie = f"{COOKIE}={self._rules.token}; HttpOnly; SameSite=Strict; Path=/"
                    headers.append((b"set-cookie", cookie.encode()))
                message["headers"] = headers
            await send(message)

        return dressed  # type: ignore[return-value]


def _host(header: str) -> str:
    """The name in a Host header, without its port."""
    return (urlsplit(f"//{header}").hostname or "") if header else ""
