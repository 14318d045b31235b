"""Hands on the window of this display that takes files: what a desktop sends it when a user drops files, points, clicks, types.

usage: hands.py ACTION...    in order:
  drop=FILE|FILE    drops files as a file manager does (XDND 5), and waits until the window says that it has them
  move=X,Y  press=BUTTON  release=BUTTON  click=X,Y  wheel=NOTCHES    window's pixels; buttons 1 (left) to 3; notches up are positive
  key=NAME          by its name in X: Right, w
  title=TEXT        waits until the window is called so
Fails if no window takes files within a minute, if it does not want these, or if it does not say that it has them.
"""
import ctypes
import pathlib
import sys
import time

KEY_PRESS, KEY_RELEASE, BUTTON_PRESS, BUTTON_RELEASE, MOTION = 2, 3, 4, 5, 6
SELECTION_REQUEST, SELECTION_NOTIFY, CLIENT_MESSAGE = 30, 31, 33
MASKS = {KEY_PRESS: 1, KEY_RELEASE: 2, BUTTON_PRESS: 4, BUTTON_RELEASE: 8, MOTION: 64}
WHEEL_UP, WHEEL_DOWN = 4, 5  # buttons, to X
VERSION, PATIENCE_S = 5, 60

Id, Long, Int, Pointer = ctypes.c_ulong, ctypes.c_long, ctypes.c_int, ctypes.c_void_p


def event(*fields):
    """An event of X: what all begin with, then `fields`."""
    begin = [("type", Int), ("serial", Id), ("send_event", Int), ("display", Pointer)]
    return type("Event", (ctypes.Structure,), {"_fields_": begin + list(fields)})


Message = event(("window", Id), ("message_type", Id), ("format", Int), ("l", Long * 5))
Request = event(("owner", Id), ("requestor", Id), ("selection", Id), ("target", Id), ("property", Id), ("time", Id))
Notify = event(("requestor", Id), ("selection", Id), ("target", Id), ("property", Id), ("time", Id))
# Keys and buttons; of motion `detail` is a flag, alike in memory as far as it is 0.
Input = event(("window", Id), ("root", Id), ("subwindow", Id), ("time", Id), ("x", Int), ("y", Int), ("x_root", Int), ("y_root", Int),
              ("state", ctypes.c_uint), ("detail", ctypes.c_uint), ("same_screen", Int))


class AnyEvent(ctypes.Union):
    _fields_ = [("type", Int), ("message", Message), ("request", Request), ("notify", Notify), ("input", Input), ("room", Long * 24)]


x11 = ctypes.CDLL("libX11.so.6")
for name, result, *arguments in [
        ("XOpenDisplay", Pointer, ctypes.c_char_p), ("XDefaultRootWindow", Id, Pointer),
        ("XInternAtom", Id, Pointer, ctypes.c_char_p, Int),
        ("XCreateSimpleWindow", Id, Pointer, Id, Int, Int, ctypes.c_uint, ctypes.c_uint, ctypes.c_uint, Id, Id),
        ("XFetchName", Int, Pointer, Id, Pointer), ("XQueryTree", Int, Pointer, Id, *3 * [Pointer], Pointer), ("XFree", Int, Pointer),
        ("XListProperties", Pointer, Pointer, Id, Pointer), ("XSetSelectionOwner", Int, Pointer, Id, Id, Id),
        ("XTranslateCoordinates", Int, Pointer, Id, Id, Int, Int, *3 * [Pointer]),
        ("XSendEvent", Int, Pointer, Id, Int, Long, Pointer), ("XPending", Int, Pointer), ("XNextEvent", Int, Pointer, Pointer),
        ("XChangeProperty", Int, Pointer, Id, Id, Id, Int, Int, ctypes.c_char_p, Int), ("XFlush", Int, Pointer),
        ("XStringToKeysym", Id, ctypes.c_char_p), ("XKeysymToKeycode", ctypes.c_ubyte, Pointer, Id), ("XSync", Int, Pointer, Int)]:
    function = getattr(x11, name)
    function.restype, function.argtypes = result, arguments


class Hands:
    def __init__(self):
        self.display = x11.XOpenDisplay(None)
        assert self.display, "no display"
        self.root = x11.XDefaultRootWindow(self.display)
        self.source = x11.XCreateSimpleWindow(self.display, self.root, 0, 0, 1, 1, 0, 0, 0)
        self.content = b""
        self.until = time.monotonic() + PATIENCE_S
        self.target, self.now, self.at = self.find_target(), 1000, (1, 1)

    def atom(self, name):
        return x11.XInternAtom(self.display, name.encode(), 0)

    def children(self, window):
        parent, root, count, list_ = Id(), Id(), ctypes.c_uint(), ctypes.POINTER(Id)()
        x11.XQueryTree(self.display, window, ctypes.byref(root), ctypes.byref(parent), ctypes.byref(list_), ctypes.byref(count))
        found = [list_[i] for i in range(count.value)]
        if list_:
            x11.XFree(list_)
        return found

    def takes_files(self, window):
        count = Int()
        list_ = x11.XListProperties(self.display, window, ctypes.byref(count))
        names = ctypes.cast(list_, ctypes.POINTER(Id))
        found = any(names[i] == self.atom("XdndAware") for i in range(count.value))
        if list_:
            x11.XFree(list_)
        return found

    def find_target(self):
        while time.monotonic() < self.until:
            for child in self.children(self.root):
                for window in [child, *self.children(child)]:
                    if self.takes_files(window):
                        return window
            time.sleep(0.05)
        raise SystemExit("no window takes files")

    def send(self, kind, *words):
        sent = AnyEvent()
        sent.message = Message(CLIENT_MESSAGE, 0, 1, self.display, self.target, self.atom(kind), 32,
                               (Long * 5)(self.source, *words))
        x11.XSendEvent(self.display, self.target, 0, 0, ctypes.byref(sent))
        x11.XFlush(self.display)

    def hand_over(self, request):
        """The list of files, to the window that asks for it."""
        x11.XChangeProperty(self.display, request.requestor, request.property, request.target, 8, 0, self.content, len(self.content))
        sent = AnyEvent()
        sent.notify = Notify(SELECTION_NOTIFY, 0, 1, self.display, request.requestor, request.selection, request.target,
                             request.property, request.time)
        x11.XSendEvent(self.display, request.requestor, 0, 0, ctypes.byref(sent))
        x11.XFlush(self.display)

    def wait_for(self, kind):
        """The message `kind`; what the window asks for meanwhile is answered."""
        got = AnyEvent()
        while time.monotonic() < self.until:
            if not x11.XPending(self.display):
                time.sleep(0.005)
                continue
            x11.XNextEvent(self.display, ctypes.byref(got))
            if got.type == SELECTION_REQUEST:
                self.hand_over(got.request)
            elif got.type == CLIENT_MESSAGE and got.message.message_type == self.atom(kind):
                return got.message.l
        raise SystemExit(f"no {kind} within {PATIENCE_S} s")

    def drop(self, paths):
        self.content = "".join(f"{pathlib.Path(path).resolve().as_uri()}\r\n" for path in paths).encode()
        x, y, child = Int(), Int(), Id()
        x11.XTranslateCoordinates(self.display, self.target, self.root, 400, 100, ctypes.byref(x), ctypes.byref(y), ctypes.byref(child))
        x11.XSetSelectionOwner(self.display, self.atom("XdndSelection"), self.source, 0)
        self.send("XdndEnter", VERSION << 24, self.atom("text/uri-list"), 0, 0)
        self.send("XdndPosition", 0, x.value << 16 | y.value, 0, self.atom("XdndActionCopy"))
        assert self.wait_for("XdndStatus")[1] & 1, "the window does not want these files"
        self.send("XdndDrop", 0, 0, 0, 0)
        # XDND asks for the lowest bit; GLFW 3.3 says how many bytes it took.
        assert self.wait_for("XdndFinished")[1] != 0, "the window did not take the files"

    def give(self, kind, detail=0):
        self.now += 100  # times rise, or a window takes a key for one it has seen
        sent = AnyEvent()
        sent.input = Input(kind, 0, 1, self.display, self.target, self.root, 0, self.now, *self.at, *self.at, 0, detail, 1)
        x11.XSendEvent(self.display, self.target, 1, MASKS[kind], ctypes.byref(sent))

    def key(self, name):
        code = x11.XKeysymToKeycode(self.display, x11.XStringToKeysym(name.encode()))
        assert code, f"no key {name}"
        self.give(KEY_PRESS, code)
        self.give(KEY_RELEASE, code)

    def move(self, place):
        x, y = place.split(",")
        self.at = int(x), int(y)
        self.give(MOTION)

    def wait_for_title(self, text):
        name = ctypes.c_char_p()
        while time.monotonic() < self.until:
            if x11.XFetchName(self.display, self.target, ctypes.byref(name)) and name.value == text.encode():
                return
            time.sleep(0.05)
        raise SystemExit(f"the window is called {name.value}, not {text}")

    def act(self, action):
        what, _, how = action.partition("=")
        if what == "drop":
            self.drop(how.split("|"))
        elif what == "title":
            self.wait_for_title(how)
        elif what == "key":
            self.key(how)
        elif what == "move":
            self.move(how)
        elif what == "click":
            self.move(how)
            self.give(BUTTON_PRESS, 1)
            self.give(BUTTON_RELEASE, 1)
        elif what == "wheel":
            for _ in range(abs(int(how))):
                self.give(BUTTON_PRESS, WHEEL_UP if int(how) > 0 else WHEEL_DOWN)
        else:
            self.give({"press": BUTTON_PRESS, "release": BUTTON_RELEASE}[what], int(how))


hands = Hands()
for word in sys.argv[1:]:
    hands.act(word)
x11.XSync(hands.display, 0)
