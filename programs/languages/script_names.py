"""Names that every Python and JavaScript program has: exported functions would hide them."""

from programs.languages.spelling import words

# The built-in names of Python up to 3.14
PYTHON_LIBRARY = words(
    "ArithmeticError AssertionError AttributeError BaseException BaseExceptionGroup",
    "BlockingIOError BrokenPipeError BufferError BytesWarning ChildProcessError",
    "ConnectionAbortedError ConnectionError ConnectionRefusedError ConnectionResetError",
    "DeprecationWarning EOFError Ellipsis EncodingWarning EnvironmentError Exception",
    "ExceptionGroup False FileExistsError FileNotFoundError FloatingPointError FutureWarning",
    "GeneratorExit IOError ImportError ImportWarning IndentationError IndexError InterruptedError",
    "IsADirectoryError KeyError KeyboardInterrupt LookupError MemoryError ModuleNotFoundError",
    "NameError None NotADirectoryError NotImplemented NotImplementedError OSError OverflowError",
    "PendingDeprecationWarning PermissionError ProcessLookupError PythonFinalizationError",
    "RecursionError ReferenceError ResourceWarning RuntimeError RuntimeWarning StopAsyncIteration",
    "StopIteration SyntaxError SyntaxWarning SystemError SystemExit TabError TimeoutError True",
    "TypeError UnboundLocalError UnicodeDecodeError UnicodeEncodeError UnicodeError",
    "UnicodeTranslateError UnicodeWarning UserWarning ValueError Warning ZeroDivisionError abs",
    "aiter all anext any ascii bin bool breakpoint bytearray bytes callable chr classmethod",
    "compile complex copyright credits delattr dict dir divmod enumerate eval exec exit filter",
    "float format frozenset getattr globals hasattr hash help hex id input int isinstance",
    "issubclass iter len license list locals map max memoryview min next object oct open ord pow",
    "print property quit range repr reversed round set setattr slice sorted staticmethod str sum",
    "super tuple type vars zip numpy",
)

# The global objects of ECMAScript 2025, of browsers, and of Node's modules
JAVASCRIPT_LIBRARY = words(
    "AggregateError Array ArrayBuffer AsyncDisposableStack AsyncFunction Atomics BigInt",
    "BigInt64Array BigUint64Array Boolean DataView Date DisposableStack Error EvalError",
    "FinalizationRegistry Float16Array Float32Array Float64Array Function Generator",
    "GeneratorFunction Int16Array Int32Array Int8Array Intl Iterator JSON Map Number Object",
    "Promise Proxy RangeError ReferenceError Reflect RegExp Set SharedArrayBuffer String",
    "SuppressedError Symbol SyntaxError Temporal TypeError URIError Uint16Array Uint32Array",
    "Uint8Array Uint8ClampedArray WeakMap WeakRef WeakSet WebAssembly decodeURI decodeURIComponent",
    "encodeURI encodeURIComponent escape globalThis isFinite isNaN parseFloat parseInt unescape",
    "Buffer alert atob blur btoa cancelAnimationFrame clearInterval clearTimeout close closed",
    "confirm console constructor crypto customElements document event exports external fetch focus",
    "frames hasOwnProperty history indexedDB innerHeight innerWidth length localStorage location",
    "module name navigator open opener origin parent performance postMessage print process prompt",
    "queueMicrotask requestAnimationFrame require screen scroll self sessionStorage setInterval",
    "setTimeout status stop structuredClone toString top valueOf window",
)
