"""What is measured: the scenes, the methods, and how much of it at each level."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench import programs
from bench.programs import TOP, Size
from reference.references import scene_digest

# Where the shadow ray starts: judged by the shadow of other objects.
METHODS = ("none", "0", "1", "1 bare", "2", "2 bare", "2+", "iter:2", "iter:4", "march:2", "march:4", "march:8", "auto",
           "auto:1", "exact", "displaced")
FEWER = ("none", "0", "1", "2", "2+", "march:4", "march:8", "auto", "exact", "displaced")

# A method, and perhaps where it shades and how bumps shadow each other: judged by the whole picture.
VARIANTS = ("none", "0", "march:8", "0 shifted", "march:8 shifted", "0 shifted, own 8", "march:8 shifted, own 8",
            "march:8 shifted, own 24", "march:8 shifted, own horizon", "auto shifted", "auto shifted, own 8",
            "auto shifted, own 24", "auto:0.1 shifted, own 8", "exact shifted, own exact", "relief")
FEWER_VARIANTS = ("none", "0", "march:8 shifted", "march:8 shifted, own 8", "relief")

# How bumps shadow each other, each at the true place, so that nothing else is wrong.
OWN = ("own 4", "own 8", "own 16", "own 24", "own horizon", "own exact", "displaced")

TITLES = {
    "cube": "A cube over a bumpy plane (figures 4 to 7)",
    "sphere": "A box over a bumpy sphere (figure 8)",
    "terrain": "A ball over a terrain (observed data)",
    "torus": "A cube over a bumpy torus (function data)",
    "waves": "A cube over waves (function data)",
}


@dataclass(frozen=True)
class Level:
    """How much is measured."""

    name: str
    methods: tuple[str, ...]
    variants: tuple[str, ...]
    rounds: int  # of everything that is timed
    cost_size: Size
    povray_size: Size  # per pixel it is the same at any
    mesh_size: Size | None  # the meshes for POV-Ray are as fine as this picture needs; None: no meshes, they take long
    yardsticks: bool  # whether those of bench/limits are timed
    count_size: Size  # for valgrind
    count_scenes: tuple[str, ...]
    reference_scale: int  # the references' width and height, in those of reference/
    slopes: tuple[float, ...]  # of the sweeps
    angles: tuple[float, ...]
    frequencies: tuple[float, ...]
    widths: tuple[int, ...]
    sweep_scenes: tuple[str, ...]

    @property
    def timed(self) -> tuple[str, ...]:
        """The methods, then the variants that are no methods."""
        return tuple(dict.fromkeys((*self.methods, *self.variants)))


LEVELS = {
    level.name: level
    for level in (
        Level("quick", FEWER, FEWER_VARIANTS, 7, (400, 225), (320, 180), None, False, (64, 48), ("waves", "cube"), 1,
              (0.1, 0.2, 0.35, 0.6, 1.0), (15, 30, 45, 60, 80), (), (), ("waves",)),
        Level("normal", METHODS, VARIANTS, 7, (960, 540), (480, 270), (160, 120), True, (160, 120), tuple(TITLES), 1,
              (0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0), (10, 15, 20, 30, 40, 50, 65, 80), (0.5, 1, 2, 4, 8),
              (80, 160, 320, 640), ("waves", "cube")),
        Level("full", METHODS, VARIANTS, 15, (1920, 1080), (1280, 720), (320, 240), True, (320, 240), tuple(TITLES), 2,
              (0.03, 0.05, 0.08, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 1.4),
              (6, 10, 15, 20, 25, 30, 35, 40, 50, 60, 70, 80), (0.25, 0.5, 1, 2, 4, 8, 16), (80, 160, 320, 640, 1280),
              ("waves", "cube")),
    )
}


@dataclass(frozen=True)
class Facts:
    """What `kage check` prints of a scene, and a digest of all its files."""

    name: str
    light: str
    at: tuple[float, float, float]
    receiver: str
    casters: tuple[str, ...]
    slope_median: float
    slope_95: float
    digest: str

    @property
    def file(self) -> str:
        return f"scenes/{self.name}.yaml"


@dataclass(frozen=True)
class Bench:
    """What the jobs depend on."""

    kage: Path
    kage_digest: str
    out: Path
    level: Level
    scenes: dict[str, Facts]

    @property
    def references(self) -> Path:
        return TOP / "reference" if self.level.reference_scale == 1 else self.out / "reference"

    def picture(self, scene: str, name: str) -> Path:
        """A PNG for the report. The scale is in the path, so that one level does not overwrite another's."""
        return self.out / "pictures" / f"{self.level.reference_scale}x" / scene / f"{name}.png"

    def truth(self, scene: str, name: str) -> Path:
        """A render that others are compared with. All that it depends on is in the path."""
        return self.out / "truths" / f"{scene}-{name}-{self.kage_digest}-{self.scenes[scene].digest[:16]}" \
                                     f"-{self.level.reference_scale}x.exr"

    def whole_truth(self, scene: str, name: str) -> Path:
        """The same for whole pictures (bench/whole.py)."""
        return self.truth(scene, f"whole-{name}").with_suffix(".npz")


def facts(kage: Path, name: str) -> Facts:
    scene = f"scenes/{name}.yaml"
    found = programs.parse_check(programs.run([kage, "check", scene]))
    return Facts(name=name, digest=scene_digest(TOP / scene), **found)
