"""The verbs of the command line without Blender."""

from concurrent.futures import Executor

from spectral_tv.batches.batch import Batch
from spectral_tv.batches.options import add_scheduler
from spectral_tv.batches.worker import HERE
from spectral_tv.cli import PROGRAM
from spectral_tv.cli.accuracy import Accuracy
from spectral_tv.cli.decompose import Decompose
from spectral_tv.cli.deform import Deform
from spectral_tv.cli.flow import Flow
from spectral_tv.cli.image import Filter
from spectral_tv.cli.segment import Segment
from spectral_tv.command_line import program

VERBS = (Decompose, Flow, Deform, Segment, Accuracy, Filter)


def run(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded."""
    return program.run(PROGRAM, VERBS, arguments, HERE, add_scheduler)


def batch(arguments: list[str], executor: Executor | None) -> Batch:
    """What the command line says, to be done by an executor; raises WrongArguments."""
    command = program.command_of(PROGRAM, VERBS, arguments, HERE, add_scheduler)
    return command.batch(executor, quiet=True)
