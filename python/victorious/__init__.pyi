from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__version__: str

_Box = tuple[float, float, float, float]
_Order = Literal["bgr", "rgb"]
_OnProgress = Callable[["Progress"], bool | None] | None
_OnWarning = Callable[[str], Any] | None

class Error(Exception):
    code: str

class InvalidArgument(Error, ValueError): ...
class NotFound(Error): ...
class AlreadyExists(Error): ...
class DataLoss(Error): ...
class Unsupported(Error): ...
class PermissionDenied(Error): ...
class NoSpace(Error): ...
class Conflict(Error): ...
class Cancelled(Error): ...
class Internal(Error): ...
class Unavailable(Error): ...

class ModelKind:
    PHOTOS: ModelKind
    CAD: ModelKind
    CATEGORY: ModelKind

class Model:
    name: str
    id: str
    kind: ModelKind
    length_m: float | None
    views: int
    features: int
    @staticmethod
    def load(file: str) -> Model: ...
    @staticmethod
    def from_cad(
        name: str, file: str, *, length_m: float | None = None, step_deg: float | None = None,
        max_off_nadir_deg: float | None = None, up: str = "", front: str = "", params: str = "",
        progress: _OnProgress = None, warn: _OnWarning = None,
    ) -> Model: ...
    @staticmethod
    def from_photos(
        name: str, files: Sequence[str], *, boxes: Sequence[_Box] | None = None, length_m: float | None = None,
        params: str = "",
    ) -> Model: ...

class ModelLibrary:
    def __init__(self, folder: str) -> None: ...
    def names(self) -> list[str]: ...
    def load(self, name: str) -> Model: ...
    def load_all(self) -> list[Model]: ...
    def add(self, model: Model) -> None: ...
    def remove(self, name: str) -> None: ...

class Progress:
    label: str
    done: int
    total: int | None
    unit: str
    elapsed_s: float

class Frame:
    index: int
    time_s: float
    image: NDArray[np.uint8]

class Video:
    width: int
    height: int
    frame_rate: float
    duration_s: float | None
    warnings: list[str]
    def __init__(
        self, source: str, *, grey: bool = False, threads: int = 0, folder_frame_rate: float = 10.0
    ) -> None: ...
    def __iter__(self) -> Video: ...
    def __next__(self) -> Frame: ...
    def seek(self, time_s: float) -> bool: ...

class Detection:
    model: int
    name: str
    score: float
    neg_log10_nfa: float
    matches: int
    view: int
    box: _Box
    outline: NDArray[np.float64]

class Recognizer:
    def __init__(self, models: Sequence[Model], *, params: str = "") -> None: ...
    def recognize(self, image: NDArray[np.uint8], *, order: _Order = "bgr") -> list[Detection]: ...

class TrackStep:
    target: int
    seen: bool
    box: _Box
    confidence: float
    tentative: bool

class Tracker:
    def __init__(self, *, params: str = "") -> None: ...
    def step(self, image: NDArray[np.uint8], *, order: _Order = "bgr") -> list[TrackStep]: ...
    def start(self, box: _Box) -> TrackStep: ...
    def change_video(self) -> None: ...

class IndexReport:
    has_telemetry: bool
    frames_searched: int
    sightings: int

class Indexer:
    def __init__(
        self, models: Sequence[Model], *, categories: str = "", quality: str = "", params: str = "",
        hfov_deg: float | None = None, warn: _OnWarning = None,
    ) -> None: ...
    def index(
        self, video: str, db: str, *, telemetry: str = "", from_s: float | None = None, to_s: float | None = None,
        redo: bool = False, threads: int = 0, progress: _OnProgress = None, warn: _OnWarning = None,
    ) -> IndexReport: ...

class Motion:
    speed_m_s: float
    sigma_speed_m_s: float
    course_deg: float
    sigma_course_deg: float

class Place:
    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    time_s: float
    covariance_enu_m2: NDArray[np.float64]
    ce90_m: float
    le90_m: float
    motion: Motion | None

class Moment:
    video: str
    first_time_s: float
    last_time_s: float
    frames: int
    video_start_utc_us: int | None

class Object:
    id: int
    rank: int
    model: str
    is_category: bool
    score: float
    frames: int
    place: Place | None
    heading_deg: float | None
    moments: list[Moment]
    rejected: str
    place_rejected: str
    against: list[str]

class Sighting:
    object: int
    model: str
    is_category: bool
    video: str
    frame: int
    time_s: float
    box: _Box
    outline: NDArray[np.float64]
    score: float
    tracked: bool
    matches: int
    distance_m: float | None
    sigma_distance_m: float | None
    utc_us: int | None

class IndexedVideo:
    name: str
    width: int
    height: int
    frame_count: int | None
    duration_s: float | None
    start_utc_us: int | None

class IndexedModel:
    name: str
    id: str
    kind: ModelKind

class Detections:
    xyxy: NDArray[np.float32]
    confidence: NDArray[np.float32]
    class_id: NDArray[np.int64]
    tracker_id: NDArray[np.int64] | None
    data: dict[str, NDArray[Any]]
    mask: None
    def __len__(self) -> int: ...
    def __getitem__(self, rows: Any) -> Detections: ...

def of_image(found: Sequence[Detection]) -> Detections: ...

class Index:
    def __init__(self, name: str) -> None: ...
    def videos(self) -> list[IndexedVideo]: ...
    def models(self) -> list[IndexedModel]: ...
    def objects(self, **conditions: Any) -> list[Object]: ...
    def sightings(self, **conditions: Any) -> Iterator[Sighting]: ...
    def detections(self, **conditions: Any) -> Detections: ...
    def frames(self, **conditions: Any) -> Iterator[tuple[str, int, Detections]]: ...
    def export(self, format: str, file: str, **conditions: Any) -> None: ...
    def to_pandas(self, **conditions: Any) -> Any: ...
    def to_geopandas(self, **conditions: Any) -> Any: ...
