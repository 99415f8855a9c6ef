"""trisect for the benchmark scripts: the same interface as the other engines' adapters."""
import ctypes as C
import os
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
LIBRARY = os.environ.get("TRISECT_COMPARE", os.path.join(HERE, "target", "release", "libtrisect_compare.so"))
OPS = dict(union=0, intersection=1, difference=2, xor=3)


class Solid:
    def __init__(self, lib, pointer):
        self.lib, self.pointer = lib, pointer

    def __del__(self):
        self.lib.trisect_free(self.pointer)


class Trisect:
    """trisect, f64; n-ary by its own n-ary call. TRISECT_THREADS: 0 for all (default), 1 for one."""
    name = "trisect"; dist = None; threads = True; precision = "f64"; native = True
    nary_how = "BooleanOptions::run over all operands"

    def __init__(self):
        lib = C.CDLL(LIBRARY)
        lib.trisect_solid.restype = lib.trisect_boolean.restype = C.c_void_p
        lib.trisect_solid.argtypes = [C.c_void_p, C.c_size_t, C.c_void_p, C.c_size_t]
        lib.trisect_boolean.argtypes = [C.c_uint32, C.c_void_p, C.c_size_t, C.c_size_t]
        lib.trisect_error.restype = C.c_char_p
        lib.trisect_count.restype = C.c_size_t
        lib.trisect_count.argtypes = [C.c_void_p, C.c_uint32]
        lib.trisect_copy.argtypes = [C.c_void_p, C.c_void_p, C.c_void_p]
        lib.trisect_free.argtypes = [C.c_void_p]
        lib.trisect_self_crossings.argtypes = [C.c_void_p]
        lib.trisect_self_crossings.restype = C.c_int64
        self.lib = lib
        self.check = False              # refuse operands that cross themselves, as the program does
        self.n = int(os.environ.get("TRISECT_THREADS", "0"))

    def version(self):
        return "0.1.0"

    def _own(self, pointer):
        if not pointer:
            raise RuntimeError(self.lib.trisect_error().decode())
        return Solid(self.lib, pointer)

    def conv(self, V, F):
        V = np.ascontiguousarray(V, np.float64).reshape(-1, 3)
        F = np.ascontiguousarray(F, np.uint32 if F.dtype == np.uint32 else np.int32).reshape(-1, 3)
        s = self._own(self.lib.trisect_solid(V.ctypes.data, len(V), F.ctypes.data, len(F)))
        if self.check and self.lib.trisect_self_crossings(s.pointer) > 0:
            raise RuntimeError("the surface crosses itself")
        return s

    def _run(self, ms, op):
        a = (C.c_void_p * len(ms))(*[m.pointer for m in ms])
        return self._own(self.lib.trisect_boolean(OPS[op], a, len(ms), self.n))

    def pair(self, a, b, op):
        return self._run([a, b], op)

    def nary(self, ms, kind):
        return self._run(ms, "union" if kind == "union" else "difference")

    def out(self, r):
        V = np.empty((self.lib.trisect_count(r.pointer, 0), 3))
        F = np.empty((self.lib.trisect_count(r.pointer, 1), 3), np.uint32)
        self.lib.trisect_copy(r.pointer, V.ctypes.data, F.ctypes.data)
        return V, F
