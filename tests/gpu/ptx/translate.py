"""PTX as C++: what a GPU's threads would do, for a host to do one after the other.

    translate.py IN.ptx OUT.cpp

Each instruction becomes a call of the function of its name, dots as underscores, in instructions.h: an instruction that is not
there does not compile, so that nothing is guessed. Kernels are found by their names (find_kernel). See NVIDIA, "Parallel Thread Execution ISA".
"""
import itertools
import re
import sys

CPP_TYPES = {"pred": "bool", "b8": "std::uint8_t", "u8": "std::uint8_t", "s8": "std::int8_t", "b16": "std::uint16_t",
             "u16": "std::uint16_t", "s16": "std::int16_t", "b32": "std::uint32_t", "u32": "std::uint32_t",
             "s32": "std::int32_t", "f32": "float", "b64": "std::uint64_t", "u64": "std::uint64_t",
             "s64": "std::int64_t", "f64": "double"}
SIZES = {"b8": 1, "u8": 1, "b16": 2, "u16": 2, "b32": 4, "u32": 4, "f32": 4, "b64": 8, "u64": 8, "f64": 8}


MEETINGS = itertools.count(1)


def name(text):
    return re.sub(r"\W", "_", text.strip().lstrip("%$"))


def operand(text):
    text = text.strip()
    if re.fullmatch(r"%n?(tid|ctaid)\.x", text):
        return "thread." + name(text).replace("_x", "")
    if text.startswith("%"):
        return "r_" + name(text)
    if re.fullmatch(r"0[fF][0-9a-fA-F]{8}", text):
        return f"std::bit_cast<float>(0x{text[2:]}U)"
    if re.fullmatch(r"0[dD][0-9a-fA-F]{16}", text):
        return f"std::bit_cast<double>(0x{text[2:]}ULL)"
    if re.fullmatch(r"-?\d+", text):
        return f"std::uint64_t({text}LL)" if text != "-9223372036854775808" else "(std::uint64_t{1} << 63)"
    if re.fullmatch(r"[A-Za-z_$][\w$]*", text):
        return f"address({name(text)})"
    raise ValueError(f"operand {text!r}")


def address(text):
    base, offset = re.fullmatch(r"\[\s*([^\s+\]]+)\s*(?:\+\s*(-?\d+))?\s*\]", text.strip()).groups()
    return f"({operand(base)} + {offset or 0})"


def split(text):
    """Operands, at the commas that are in no braces."""
    parts, depth = [""], 0
    for c in text:
        depth += (c in "{[(") - (c in "}])")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return [part.strip() for part in parts if part.strip()]


def parameters(text):
    """(name, bytes) of each `.param`."""
    found = []
    for one in split(text):
        kind, called, count = re.fullmatch(r"\.param\s+(?:\.align\s+\d+\s+)?\.(\w+)\s+([\w$]+)(?:\[(\d+)\])?", one).groups()
        found.append((name(called), SIZES[kind] * int(count or 1)))
    return found


def moved(op, values, place, is_load):
    """A load or store of one register, or of a vector of them."""
    kind = CPP_TYPES[op[-1]]
    statements = []
    for i, value in enumerate(split(values.strip("{}"))):
        at = f"{place} + {i} * sizeof({kind})"
        statements.append(f"put({operand(value)}, load<{kind}>({at}));" if is_load
                          else f"store<{kind}>({at}, {operand(value)});")
    return "{ " + " ".join(statements) + " }"


def instruction(text):
    guard = ""
    guarded = re.fullmatch(r"@(!?)(%\w+)\s+(.*)", text, re.DOTALL)
    if guarded:
        guard = f"if ({guarded[1]}{operand(guarded[2])}) "
        text = guarded[3]
    opcode, _, rest = text.partition(" ") if " " in text else (text, "", "")
    op, args = opcode.split("."), split(rest)
    if op[0] == "call":
        return guard + call(rest)
    if op[0] == "bra":
        return f"{guard}goto {name(args[0])};"
    if op[0] in ("ret", "exit"):
        return guard + "return;"
    if op[0] == "ld":
        return guard + moved(op, args[0], address(args[1]), True)
    if op[0] == "st":
        return guard + moved(op, args[1], address(args[0]), False)
    if op[0] == "atom":
        return f"{guard}put({operand(args[0])}, atom_{op[-2]}_{op[-1]}({address(args[1])}, {operand(args[2])}));"
    if op[0] == "mov" and "{" in rest:
        packs = args[1].startswith("{")
        words = ", ".join(map(operand, split(args[packs].strip("{}"))))
        return (f"{guard}put({operand(args[0])}, pack({words}));" if packs else f"{guard}unpack({operand(args[1])}, {words});")
    if op[0] in ("mov", "cvta"):
        return f"{guard}put({operand(args[0])}, {operand(args[1])});"
    if op[0] in ("shfl", "vote"):  # where lanes meet: each by its number
        args[0] = args[0].split("|")[0]
        return (f"{guard}put({operand(args[0])}, "
                f"{name(opcode)}({', '.join(map(operand, args[1:]))}, {next(MEETINGS)}));")
    return f"{guard}put({operand(args[0])}, {name(opcode)}({', '.join(map(operand, args[1:]))}));"


def call(rest):
    result, function, args = re.fullmatch(r"(?:\(\s*(\w+)\s*\)\s*,\s*)?([\w$]+)\s*(?:,\s*\(([^)]*)\))?", rest.strip(),
                                          re.DOTALL).groups()
    passed = ([result] if result else []) + (split(args) if args else [])
    return f"{name(function)}({', '.join(map(name, passed))});"


def body(text):
    """Declarations of all registers first, so that no jump crosses one."""
    registers, code = [], []
    text = re.sub(r"(\$[\w$]+):", r"LABEL \1;", text)
    text = re.sub(r"(?m)^\s*([{}])\s*$", r"\1;", text)  # of a sequence of a call, and not of a vector
    for statement in re.split(r";", text):
        statement = " ".join(statement.split())
        if not statement or statement.startswith(".pragma") or "temp_param_reg" in statement:
            continue
        if statement in "{}":
            code.append(statement)
        elif statement.startswith("LABEL"):
            code.append(f"{name(statement[6:])}:;")
        elif statement.startswith(".reg"):
            kind, rest = re.fullmatch(r"\.reg \.(\w+) (.*)", statement).groups()
            for called in split(rest):
                many = re.fullmatch(r"%([\w$]+)<(\d+)>", called)
                names = [f"%{many[1]}{i}" for i in range(int(many[2]))] if many else [called]
                registers.append(f"{CPP_TYPES[kind]} {', '.join(operand(n) + '{}' for n in names)};")
        elif statement.startswith((".local", ".param")):
            called, size = re.fullmatch(r"\.\w+ (?:\.align \d+ )?\.(\w+ [\w$]+(?:\[\d+\])?)", statement)[1].split(" ")[1], 0
            kind = re.search(r"\.(\w+) [\w$]+(?:\[\d+\])?$", statement)[1]
            count = re.search(r"\[(\d+)\]$", called)
            size = SIZES[kind] * int(count[1] if count else 1)
            line = f"alignas(16) std::uint8_t {name(called.split('[')[0])}[{size}] = {{}};"
            (registers if statement.startswith(".local") else code).append(line)
        else:
            code.append(instruction(statement))
    return registers + code


def enclosed(text, start):
    """What is between the brace at or after `start` and its partner."""
    first = text.index("{", start)
    depth = 0
    for i in range(first, len(text)):
        depth += (text[i] == "{") - (text[i] == "}")
        if depth == 0:
            return text[first + 1:i]
    raise ValueError("a brace is not closed")


def translate(text):
    text = re.sub(r"//.*", "", text)
    constants, prototypes, functions, kernels = [], {}, [], []
    for align, called, size, values in re.findall(
            r"\.global \.align (\d+) \.b8 ([\w$]+)\[(\d+)\](?: = \{([^}]*)\})?;", text):
        constants.append(f"alignas({align}) static std::uint8_t {name(called)}[{size}] = {{{values or 0}}};")
    for found in re.finditer(r"\.func\s*(?:\(([^)]*)\))?\s*([\w$]+)\s*\(([^)]*)\)", text):
        result = [f"std::uint8_t* {n}" for n, _ in parameters(found[1])] if found[1] else []
        taken = [f"const std::uint8_t* {n}" for n, _ in parameters(found[3])]
        head = f"static void {name(found[2])}({', '.join(result + taken)})"
        prototypes[head] = None
        rest = text[found.end():].lstrip()
        if not rest.startswith(";") and not rest.startswith(".noreturn"):
            functions.append((head, body(enclosed(text, found.end()))))
    for found in re.finditer(r"\.entry\s+([\w$]+)\s*\(([^)]*)\)", text):
        taken = [n for n, _ in parameters(found[2])]
        head = f"static void {name(found[1])}({', '.join(f'const std::uint8_t* {n}' for n in taken)})"
        kernels.append((name(found[1]), len(taken)))
        functions.append((head, body(enclosed(text, found.end()))))
    lines = ['#include "tests/gpu/ptx/instructions.h"', "namespace raypool::ptx {", "namespace {", *constants,
             *(head + ";" for head in prototypes)]
    for head, code in functions:
        lines += [head + " {", *("    " + line for line in code), "}"]
    for kernel, count in kernels:
        passed = ", ".join(f"static_cast<const std::uint8_t*>(p[{i}])" for i in range(count))
        lines.append(f'const Kernel k_{kernel}("{kernel}", [](void* const* p) {{ {kernel}({passed}); }});')
    lines.append("}")
    lines.append("}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        cpp = translate(file.read())
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(cpp)
