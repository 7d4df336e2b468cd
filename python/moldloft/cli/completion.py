"""``moldloft completion``: completion scripts of shells, made from the commands' own arguments."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "shell",
        metavar="SHELL",
        choices=["bash", "zsh", "fish", "powershell"],
        help="bash, zsh, fish or powershell",
    )


def run(options: argparse.Namespace) -> int:
    """Prints the script."""
    write = {"bash": _bash, "zsh": _zsh, "fish": _fish, "powershell": _powershell}
    print(write[options.shell](), end="")
    return 0


def _commands() -> Iterator[tuple[str, str, list[tuple[list[str], str, list[str]]]]]:
    """Each command with its line and its options: names, help, choices."""
    from moldloft.cli import COMMANDS, whole_parser

    parser = whole_parser(list(COMMANDS))
    groups = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    for name, command in next(groups).choices.items():
        rows = []
        for action in command._actions:
            if action.help != argparse.SUPPRESS:
                words = " ".join((action.help or "").split())
                short = words.split(";")[0].split(":")[0]
                rows.append((list(action.option_strings), short, _choices(action)))
        yield name, COMMANDS[name], rows


def _choices(action: argparse.Action) -> list[str]:
    if action.choices is not None:
        return [str(choice) for choice in action.choices]
    if action.metavar == "FORMAT":
        from moldloft.formats import formats

        return list(formats())
    return []


def _bash() -> str:
    cases = []
    for name, _, rows in _commands():
        options = " ".join(word for names, _, _ in rows for word in names)
        places = " ".join(c for names, _, choices in rows if not names for c in choices)
        values = "".join(
            f"        {'|'.join(names)}) words='{' '.join(choices)}' ;;\n"
            for names, _, choices in rows
            if names and choices
        )
        inner = f"      case $previous in\n{values}      esac\n" if values else ""
        cases.append(f"    {name})\n      words='{options} {places}'\n{inner}      ;;\n")
    listed = " ".join(name for name, _, _ in _commands())
    return f"""\
# bash completion of moldloft
_moldloft() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} k words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W '{listed} --help --version' -- "$current"))
    return
  fi
  # A list such as `--to gdf stl` continues until the next option.
  for ((k = COMP_CWORD - 1; k > 1; k--)); do
    case ${{COMP_WORDS[k]}} in --to|--tag) previous=${{COMP_WORDS[k]}}; break ;; -*) break ;; esac
  done
  case ${{COMP_WORDS[1]}} in
{"".join(cases)}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  [ "${{#COMPREPLY[@]}}" -eq 0 ] && COMPREPLY=($(compgen -f -- "$current"))
}}
complete -o filenames -F _moldloft moldloft
"""


def _quoted(text: str) -> str:
    return text.replace("\\", "\\\\").replace("'", "'\\''")


def _zsh() -> str:
    cases = []
    for name, _, rows in _commands():
        specs = []
        for names, text, choices in rows:
            about = _quoted(text).replace("[", "(").replace("]", ")").replace(":", " ")
            values = f":value:({' '.join(choices)})" if choices else ""
            specs += [f"'{word}[{about}]{values}'" for word in names]
            if not names and choices:
                specs.append(f"'1{values}'")
        lines = " \\\n        ".join([*specs, "'*:file:_files'"])
        cases.append(f"      {name})\n        _arguments {lines} ;;\n")
    listed = "\n".join(f"    '{name}:{_quoted(line)}'" for name, line, _ in _commands())
    return f"""\
#compdef moldloft
_moldloft() {{
  local -a commands
  commands=(
{listed}
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{"".join(cases)}  esac
}}
if [ "$funcstack[1]" = "_moldloft" ]; then _moldloft "$@"; else compdef _moldloft moldloft; fi
"""


def _fish() -> str:
    lines = ["# fish completion of moldloft", "complete -c moldloft -e"]
    for name, line, rows in _commands():
        line = _quoted(line)
        lines.append(f"complete -c moldloft -n __fish_use_subcommand -f -a {name} -d '{line}'")
        seen = f"__fish_seen_subcommand_from {name}"
        for names, about, choices in rows:
            words = [f"complete -c moldloft -n '{seen}'"]
            for option in names:
                words.append(f"-l {option[2:]}" if option.startswith("--") else f"-s {option[1:]}")
            if choices:
                words.append(f"{'-x ' if names else '-f '}-a '{' '.join(choices)}'")
            if names:
                words.append(f"-d '{_quoted(about)}'")
            if names or choices:
                lines.append(" ".join(words))
    return "\n".join(lines) + "\n"


def _powershell() -> str:
    rows = []
    for name, _, options in _commands():
        words = [word for names, _, choices in options for word in [*names, *choices]]
        rows.append(f"    '{name}' = @({', '.join(repr(word) for word in words)})")
    table = "\n".join(rows)
    return f"""\
# PowerShell completion of moldloft
Register-ArgumentCompleter -Native -CommandName moldloft -ScriptBlock {{
  param($word, $tree, $position)
  $options = @{{
{table}
  }}
  $given = @($tree.CommandElements | ForEach-Object {{ $_.ToString() }})
  $words = if ($given.Count -gt 1 -and $options.ContainsKey($given[1])) {{ $options[$given[1]] }}
           else {{ $options.Keys }}
  $words | Where-Object {{ $_ -like "$word*" }} | ForEach-Object {{
    [System.Management.Automation.CompletionResult]::new($_, $_, 'ParameterValue', $_)
  }}
}}
"""
