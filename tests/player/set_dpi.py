"""Says of the display in DISPLAY that it has so many dots an inch, as a desktop does (Xft.dpi): set_dpi.py DPI.

The server must not reset when its last client goes (-noreset).
"""
import ctypes
import sys

x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XDefaultRootWindow.argtypes = [ctypes.c_void_p]
x11.XDefaultRootWindow.restype = ctypes.c_ulong
x11.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
x11.XInternAtom.restype = ctypes.c_ulong
x11.XChangeProperty.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_ulong, ctypes.c_ulong, ctypes.c_int, ctypes.c_int,
                                ctypes.c_char_p, ctypes.c_int]
x11.XCloseDisplay.argtypes = [ctypes.c_void_p]

text = f"Xft.dpi:\t{int(sys.argv[1])}\n".encode()
display = x11.XOpenDisplay(None)
assert display, "no display"
name, kind = (x11.XInternAtom(display, word, 0) for word in (b"RESOURCE_MANAGER", b"STRING"))
x11.XChangeProperty(display, x11.XDefaultRootWindow(display), name, kind, 8, 0, text, len(text))
x11.XCloseDisplay(display)
