"""``concio window [FILE]``: draw, click, see, in the browser."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.outcome import flush, guarded, note, say

if TYPE_CHECKING:
    from concio.window.server import Server
    from concio.window.session import Session


@guarded
def window(
    file: Annotated[
        Path | None,
        typer.Argument(help="Model, drawing, solids, picture or folder; by default this folder.", show_default=False),
    ] = None,
    folder: Annotated[
        Path | None, typer.Option("--folder", help="Folder in which files may be opened; by default that of the file.")
    ] = None,
    port: Annotated[int, typer.Option("--port", help="Port of the page; 0 selects a free one.")] = 0,
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open it in the browser.")] = True,
) -> int:
    """Open the graphical interface in the browser, to draw, load, solve and report. Ctrl-C ends it.

    The page is served on this machine, and no data leaves it. Unsaved changes are kept in a journal beside the file.

    Example: concio window wall.toml
    """
    from concio.errors import InputError

    if file is not None and file.is_dir():
        file, folder = None, folder or file
    place = folder or (file.parent if file is not None else Path())
    if not place.is_dir():
        msg = "there is no such folder"
        raise InputError(msg, where=str(place), hint="give the name of a folder that exists")
    model = None if file is None else model_file(file, place)
    from concio.window.lane import PATIENCE, Lane

    worker = [sys.executable, "-m", "concio.cli.answering_process"]
    look = Lane(worker, PATIENCE)
    look.start()  # it loads what pictures need while this process loads the server
    from concio.window.server import Server
    from concio.window.session import Session

    try:
        session = Session(place, worker, model, look)
    except InputError:
        look.close()
        raise
    try:
        server = _server(Server, session, port)
        if session.document is not None and session.document.read_only:
            note(f"Note: {session.document.read_only}")
        say(f"The window is at {server.address}")
        say("Ctrl-C ends it. Changes that are not saved are kept in a journal beside the file.")
        flush()
        if show:
            import webbrowser

            if not webbrowser.open(server.address):
                say("No browser could be started; open this address in a browser.")
        try:
            server.serve_forever(poll_interval=0.2)
        except KeyboardInterrupt:
            say("Ended.")
        finally:
            server.server_close()
    finally:
        session.close()
    return 0


def _server(make: type[Server], session: Session, port: int) -> Server:
    from concio.errors import InputError

    try:
        return make(session, port)
    except (OSError, OverflowError) as error:
        msg = f"the port {port} cannot be used: {getattr(error, 'strerror', None) or error}"
        raise InputError(msg, where="--port", hint="leave it out, and a free one is taken") from None


def model_file(file: Path, folder: Path) -> Path:
    """Return the model file to open: of anything else the file beside it that names it, made if missing.

    Raises
    ------
    InputError
        There is no such file, it is in another folder, or it is neither a model nor a drawing.
    """
    from concio.errors import InputError
    from concio.files import check_regular
    from concio.window.folder import named
    from concio.window.starting import model_text

    check_regular(file, hint="start one with: concio new panel")
    if file.parent.resolve() != folder.resolve():
        if not file.resolve().is_relative_to(folder.resolve()):
            msg = "the file is not in the folder of the window"
            raise InputError(msg, where=str(file), hint="give a folder that holds it with --folder")
    else:
        named(folder, file.name)
    text = model_text(file)
    if text is None:
        return file
    model = file.with_suffix(".toml")
    if not model.exists():
        model.write_text(text, encoding="utf-8")
    return model
