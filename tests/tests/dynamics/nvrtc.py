"""Compiles CUDA sources by NVRTC, NVIDIA's compiler as a library, to PTX; no GPU is needed.

    python3 nvrtc.py SOURCE.cu ...

Exit codes: 0 all compile; 1 one does not, with the compiler's words on stderr; 77 the package nvidia-cuda-nvrtc-cu12 is not there.
"""

import ctypes
import sys
from pathlib import Path

# Any architecture would do: what it compiles to is not run.
OPTIONS = [b"--gpu-architecture=compute_80"]


def library():
    try:
        from nvidia import cuda_nvrtc
    except ImportError:
        print("the Python package nvidia-cuda-nvrtc-cu12 is not there", file=sys.stderr)
        sys.exit(77)
    folder = Path(list(cuda_nvrtc.__path__)[0]) / "lib"
    return ctypes.CDLL(str(next(folder.glob("libnvrtc.so.*"))))


def compiled(nvrtc, source: Path) -> bool:
    program = ctypes.c_void_p()
    text = source.read_bytes()
    assert nvrtc.nvrtcCreateProgram(ctypes.byref(program), text, source.name.encode(), 0, None, None) == 0
    options = (ctypes.c_char_p * len(OPTIONS))(*OPTIONS)
    code = nvrtc.nvrtcCompileProgram(program, len(OPTIONS), options)
    if code != 0:
        size = ctypes.c_size_t()
        nvrtc.nvrtcGetProgramLogSize(program, ctypes.byref(size))
        log = ctypes.create_string_buffer(size.value)
        nvrtc.nvrtcGetProgramLog(program, log)
        print(f"{source}: {log.value.decode()}", file=sys.stderr)
    nvrtc.nvrtcDestroyProgram(ctypes.byref(program))
    return code == 0


def main():
    nvrtc = library()
    results = [compiled(nvrtc, Path(source)) for source in sys.argv[1:]]
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
