"""``accuracy``: files in, the errors of their bands out."""

import csv
import io
import sys
from functools import cached_property
from pathlib import Path

import spectral_tv
from spectral_tv.attributes.accuracy import ERRORS, arguments, measured, table, told
from spectral_tv.cli.formats import with_numbers
from spectral_tv.cli.reading import Read
from spectral_tv.cli.settings import AccuracySettings
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.verb import FileVerb
from spectral_tv.cli.writing import Result
from spectral_tv.command_line.progress import progress, say
from spectral_tv.files.whole import write_text
from spectral_tv.options.arguments import read as read_options
from spectral_tv.refusal import Refusal

CSV = ".csv"


class Accuracy(FileVerb):
    """Measures how accurate bands are for the number of steps."""

    name = "accuracy"
    summary = "measure the errors of bands by the number of time steps"
    description = """\
Measure how the errors of bands fall with the number of steps, against a flow with eight times as
many: for the steps that are asked for, a half and a quarter of them.

The table, in percent, goes to standard output, or to the .csv that is named by -o. A mesh that is
named gets the errors with the most steps as numbers at its vertices, as lengths: error_bands,
error_all_pass, and those of the paper's steps, error_paper_bands and error_paper_all_pass."""
    examples = """\
  {program} accuracy bunny.ply --method m2 --steps 64
  {program} accuracy *.ply -o tables --format csv
  {program} accuracy bunny.ply -o errors.vtu --report report.jsonl"""

    options = AccuracySettings
    example = "csv"
    is_required = False
    result = "numbers at its vertices"

    @classmethod
    def suffixes(cls) -> list[str]:
        """What it writes."""
        return [CSV, *with_numbers()]

    @cached_property
    def asked(self) -> AccuracySettings:
        """The options that were chosen."""
        found: AccuracySettings = read_options(self.choices, AccuracySettings)
        return found

    def own_complaint(self) -> str | None:
        """What is wrong with the method, the steps and the sizes."""
        asked = self.asked
        if 0 < asked.largest <= asked.finest:
            return "--largest has to be larger than --finest"
        try:
            measured(asked)
        except Refusal as error:
            return str(error)
        return None

    def treat(
        self, read: Read, source: Path, _target: Path | None, done: dict[str, object]
    ) -> Result:
        """Measure the errors."""
        asked = measured(self.asked)
        surface = Surface.of(read, asked)
        found = arguments(asked, surface.mesh, surface.base(asked))
        with progress(str(source)) as show:
            result = spectral_tv.accuracy(surface.mesh, progress=show, **found)
        self._table = table(surface.mesh, result)
        done["accuracy"] = [
            {name: float(value) for name, value in row.items()}
            for row in csv.DictReader(io.StringIO(self._table))
        ]
        say(f"{source}: {told(self._table)}")
        most = int(result.steps.argmax())
        numbers = {
            f"error_{name}": surface.to_vertices(getattr(result, name)[most])
            for _, name, _ in ERRORS
        }
        return Result(numbers=numbers)

    def finish(self, read: Read, result: Result, target: Path | None) -> None:
        """Write the table, or the errors at the vertices."""
        if target is None:
            sys.stdout.write(self._table)
        elif target.suffix.lower() == CSV:
            write_text(target, self._table)
        else:
            super().finish(read, result, target)
