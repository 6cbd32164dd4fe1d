"""A headless Chromium, driven through chromedriver by its own protocol (W3C WebDriver)."""

import base64
import json
import shutil
import subprocess
import urllib.request
from contextlib import suppress

import pytest

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # fixed by the standard
ARGUMENTS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--host-resolver-rules=MAP * ~NOTFOUND", "--force-device-scale-factor=1"]
KEYS = {"tab": "\ue004", "home": "\ue011", "end": "\ue010", "left": "\ue012", "right": "\ue014"}


class Browser:
    """One page at a time; use it in a `with` statement."""

    def __init__(self, size=(1280, 900)):
        if not shutil.which("chromedriver"):
            pytest.skip("needs Chromium and chromedriver (chromium-driver)")
        self.process = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True)
        line = next(line for line in self.process.stdout if "started successfully on port" in line)
        port = line.strip().rstrip(".").split()[-1]
        self.base = f"http://127.0.0.1:{port}/session"
        options = {"args": [*ARGUMENTS, f"--window-size={size[0]},{size[1]}"]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options,
                  "goog:loggingPrefs": {"browser": "ALL"},
                  "timeouts": {"script": 100000}}   # less than that of a call [ms]
        found = self.call("", {"capabilities": {"alwaysMatch": wanted}})
        self.base += f"/{found['sessionId']}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with suppress(OSError):
            self.call("", method="DELETE")
        self.process.terminate()
        self.process.communicate()

    def call(self, path, body=None, method="POST"):
        """Send one command; return its value."""
        data = None if method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.base + path, data, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def open(self, path):
        """Load a file; a page of a result is ready once it tells the load."""
        self.call("/url", {"url": path.resolve().as_uri()})
        ready = "return !document.getElementById('now') || document.getElementById('now').textContent"
        for _ in range(200):
            if self.run(ready):
                break

    def look(self, width, mode, forces=False):
        """Show pages in a window of this width, for a reader of the light or dark colour scheme; it may
        force darkness on pages without one."""
        for command, values in (
            ("Emulation.setDeviceMetricsOverride",
             {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}),
            ("Emulation.setEmulatedMedia",
             {"features": [{"name": "prefers-color-scheme", "value": mode}]}),
            ("Emulation.setAutoDarkModeOverride", {"enabled": forces}),
        ):
            self.call("/goog/cdp/execute", {"cmd": command, "params": values})

    def run(self, script, *arguments):
        """Return what a script of the page returns, after the next picture was drawn."""
        body = f"const done = arguments[arguments.length - 1]; const f = () => {{ {script} }};" \
               "requestAnimationFrame(() => setTimeout(() => done(f.apply(null, arguments))));"
        return self.call("/execute/async", {"script": body, "args": list(arguments)})

    def press(self, selector, *keys):
        """Send keys to an element; a name of KEYS is that key."""
        found = self.call("/element", {"using": "css selector", "value": selector})
        text = "".join(KEYS.get(key, key) for key in keys)
        self.call(f"/element/{found[ELEMENT]}/value", {"text": text})

    def type(self, key):
        """Send one key to what has the focus."""
        code = KEYS.get(key, key)
        pressed = [{"type": kind, "value": code} for kind in ("keyDown", "keyUp")]
        self.call("/actions", {"actions": [{"type": "key", "id": "keys", "actions": pressed}]})

    def messages(self):
        """Return what stands in the console since the last call."""
        return [entry["message"] for entry in self.call("/se/log", {"type": "browser"})]

    def picture(self, path):
        """Save what the window shows as PNG."""
        path.write_bytes(base64.b64decode(self.call("/screenshot", method="GET")))

    def printed(self, path):
        """Save the page as it is printed, as PDF."""
        path.write_bytes(base64.b64decode(self.call("/print", {"background": True})))
