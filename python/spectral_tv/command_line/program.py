"""Running a command line: its arguments, signals, streams and exit code."""

import argparse
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NoReturn

from spectral_tv import __version__
from spectral_tv.batches.child import SERVE, serve
from spectral_tv.batches.task import Task
from spectral_tv.command_line import signals, streams
from spectral_tv.command_line.command import Command
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import Entry

DESCRIPTION = "Filter the detail of meshes or pictures, or move parts of meshes."


def run(
    program: str,
    verbs: Iterable[type[Command]],
    arguments: list[str],
    child: Sequence[str] | None,
    more: Callable[[Any], None] | None = None,
) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded.

    ``program`` is what users write before the verb, ``child`` what starts this program again, None
    where nothing does. ``more`` declares further arguments about many files.
    """
    try:
        with streams.may_be_lost(), signals.heeded():
            if arguments[:1] == [SERVE]:
                return serve(partial(_treat, {verb.name: verb for verb in verbs}), arguments[1])
            return command_of(program, verbs, arguments, child, more).run()
    except WrongArguments as error:
        say(str(error))
        return 2
    except SystemExit as end:  # it would close Blender, and the code would be lost
        return end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # also one that came at the beginning or the end of heeding
        return signals.code()


def command_of(
    program: str,
    verbs: Iterable[type[Command]],
    arguments: list[str],
    child: Sequence[str] | None,
    more: Callable[[Any], None] | None = None,
) -> Command:
    """What the command line says; arguments as of `run`. Raises WrongArguments."""
    choices = _parser(program, verbs, more).parse_args(arguments)
    choices.child = child
    command: Command = choices.run(choices)
    return command


class WrongArguments(ValueError):
    """The arguments make no sense; the message says why."""


class _Parser(argparse.ArgumentParser):
    """One that says in a line what is wrong."""

    def error(self, message: str) -> NoReturn:
        """Raise WrongArguments, with where more is said."""
        raise WrongArguments(f"{self.prog}: error: {message} (--help tells all arguments)")


def _treat(verbs: Mapping[str, type[Command]], task: Task, entry: Entry) -> None:
    """Do a task that another process of this program hands over."""
    verbs[task.verb](argparse.Namespace(**task.choices)).treat_input(task.source, entry)


def _parser(
    program: str,
    verbs: Iterable[type[Command]],
    more: Callable[[Any], None] | None,
) -> argparse.ArgumentParser:
    parser = _Parser(prog=program, description=DESCRIPTION)
    parser.add_argument("--version", action="version", version=f"Spectral TV {__version__}")
    commands: Any = parser.add_subparsers(metavar="COMMAND", required=True)
    for verb in verbs:
        verb.add_to(commands, program, more)
    return parser
