"""summary.md: what a study says, as a page to read, from the JSON of its run."""
import re

_PLAIN = r"[A-Za-z0-9_./-]"
_COMMANDS = "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"  # what a terminal acts on


def shell_word(word):
    """The word as a shell reads it."""
    if re.fullmatch(f"{_PLAIN}+", word):
        return word
    if not re.search(_COMMANDS, word):
        return "'" + word.replace("'", "'\\''") + "'"
    escaped = (chr(byte) if re.match(_PLAIN, chr(byte)) else f"\\x{byte:02x}" for byte in word.encode())
    return "$'" + "".join(escaped) + "'"


def markdown(header, rows):
    lines = [header, *rows]
    text = ["| " + " | ".join(cells) + " |\n" for cells in lines]
    text.insert(1, "|" + "---|" * len(header) + "\n")
    return "".join(text)


def verdict_text(finding):
    return f"**{finding['verdict']}**" + (f": {finding['why']}" if finding["why"] else "")


def machine_line(environment):
    """'AMD EPYC, 2 cores, gcc 12.2.0, commit 0123456789ab'"""
    # A run may be older than the record of what its code could use.
    widest = f" and code for {environment['simd']['instruction_sets'][-1]}" if "simd" in environment else ""
    return (f"{environment['cpu']}, {environment['cores']} cores, {environment['compiler']}{widest}, "
            f"commit {environment['commit']}")


def command_line(run):
    """What makes such a run again."""
    options = run["options"]
    command = f"raypool study {run['study']}{' --quick' if options['quick'] else ''}"
    for key in ("width", "spp", "depth", "threads", "repeats", "seed"):
        if options[key] != 0:
            command += f" --{key} {options[key]}"
    if "scene_given" in options or options["scene"] != "paper":
        command += " --scene " + shell_word(options["scene"])
    if "only" in options:
        command += " --only " + shell_word(options["only"])
    return command


def summary_page(run):
    page = f"# {run['study']}\n\n{run['question']}\n\n"
    for picture in run["pictures"]:
        page += f"![{picture['title']}]({picture['name']}.png)\n\n{picture['caption']}\n\n"
    if run["findings"]:
        rows = [[f["source"], f["claim"], f["paper"], f["ours"], verdict_text(f)] for f in run["findings"]]
        page += markdown(["paper", "claim", "its figures", "ours", "verdict"], rows) + "\n"
    for table in run["tables"]:
        page += f"## {table['title']}\n\n{markdown(table['header'], table['rows'])}\n"
    page += "".join(f"- {note}\n" for note in run["notes"])
    return page + (f"\n{machine_line(run['environment'])}. Finished {run['finished']}; the host took "
                   f"{100 * run['stolen']:.1f} % of the processor time for others.\n"
                   f"Flags and OpenMP variables are in run.json, every row in data.csv. To repeat: `{command_line(run)}`\n")
