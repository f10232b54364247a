#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The library from the outside: small projects in a temporary directory get it by every way of docs/INTEGRATION.md, build tests/packaging/picture.cpp and must
draw the pictures of a build from the tree. Manifests are checked against their documentation (tests/packaging/schemas) and against each other; what cannot be
installed here (ESP-IDF, Zephyr, PlatformIO, the Pico SDK, LVGL) is stood in for by the few functions that the files call. Arguments select checks by name."""
import concurrent.futures
import fnmatch
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
import threading

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import targets  # noqa: E402

HERE = ROOT / "tests/packaging"
WARN = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion", "-Werror"]
CXX = [os.environ.get("CXX", "g++"), "-std=c++20", "-O1"]
IN_TREE = [f"-I{ROOT}", f"-I{ROOT}/firmware"]
LIBRARY = ["CMakeLists.txt", "LICENSE", "docs/spantex.1", "firmware", "hal", "tools/cmake", "zephyr"]  # what of the tree a package reads
C_PROGRAM = '#include <spantex/spantex.h>\nint main(void) { return spantex_status_string(SPANTEX_OK)[0] != 0 ? 0 : 1; }\n'
BITE = "packaging: "  # before the name of every check that failed


class Broken(Exception):
    pass


def expect(good, reason):
    if not good:
        raise Broken(reason)


def run(*command, cwd=ROOT, fails=False, **environment):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=cwd, env=dict(os.environ, **environment))
    if (done.returncode != 0) != fails:
        raise Broken(f"{shlex.join(map(str, command))}\nended with {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-2500:]}")
    return done.stdout


def once(function):
    """What several checks need is made once, by the first that asks; if that fails, for all of them."""
    made, lock = [], threading.Lock()

    def locked(folder):
        with lock:
            if not made:
                try:
                    made.append((function(folder), None))
                except Broken as e:
                    made.append((None, e))
        if made[0][1]:
            raise made[0][1]
        return made[0][0]
    return locked


def outside(folder):
    """A folder with the program to build, and nothing else of the tree."""
    folder.mkdir(parents=True)
    for source in (HERE / "picture.cpp", ROOT / "firmware/targets/console.hpp", ROOT / "firmware/targets/semihosting.hpp"):
        shutil.copy(source, folder)
    return folder


@once
def reference(folder):
    """What the tree draws."""
    program = outside(folder / "reference") / "picture"
    run(*CXX, *WARN, *IN_TREE, program.parent / "picture.cpp", "-o", program)
    said = run(program)
    expect(len(set(said.splitlines())) == 8, f"pictures that should differ do not:\n{said}")
    return said


def expect_pictures(folder, said, who):
    expect(said == reference(folder), f"{who} draws other pictures:\n{said}the tree:\n{reference(folder)}")


def version():
    text = (ROOT / "firmware/spantex/version.h").read_text()
    parts = [re.search(rf"SPANTEX_VERSION_{p} (\d+)", text)[1] for p in ("MAJOR", "MINOR", "PATCH")]
    whole = re.search(r'SPANTEX_VERSION "([^"]+)"', text)[1]
    expect(".".join(parts) == whole, f"version.h: {'.'.join(parts)} and {whole}")
    return whole


def copy_of_library(folder):
    for name in LIBRARY:
        from_, to = ROOT / name, folder / name
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(from_, to) if from_.is_dir() else shutil.copy(from_, to)
    return folder


def cmake_project(folder, how, target="spantex::spantex", configure=(), language="CXX", source="picture.cpp"):
    (folder / "program.c").write_text(C_PROGRAM)
    warn = ";".join(WARN) if language == "CXX" else "-Wall;-Wextra;-Werror"
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(outside LANGUAGES {language})\nset(CMAKE_CXX_FLAGS -O1)\n{how}\nadd_executable(program {source})\n"
        f"target_compile_options(program PRIVATE {warn})\ntarget_link_libraries(program PRIVATE {target})\n")
    run("cmake", "-S", folder, "-B", folder / "b", "-Wdev", "-Werror=dev", *configure)
    run("cmake", "--build", folder / "b")
    return run(folder / "b/program")


@once
def installed(folder):
    """`make install`, with a stand-in for the command: what the recipe does, without building it."""
    build, stage = folder / "install/build", folder / "install/stage"
    build.mkdir(parents=True)
    (build / "spantex").write_text("#!/bin/sh\n")
    (build / "spantex").chmod(0o755)
    without = [f for target in ("all", "setup-build", "setup-install") for f in ("-o", target)]
    run("make", *without, "install", f"B={build}", "PREFIX=/opt/st", f"DESTDIR={stage}")
    return stage / "opt/st", build, stage


# ---- checks

def version_agrees(folder):
    v = version()
    told = {"library.json": json.loads((ROOT / "library.json").read_text())["version"],
            "library.properties": re.search(r"^version=(.*)$", (ROOT / "library.properties").read_text(), re.M)[1],
            "idf_component.yml": yaml_of(ROOT / "idf_component.yml")["version"]}
    for name, other in told.items():
        expect(other == v, f"{name} says {other}, firmware/spantex/version.h {v}")
    headings = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)
    expect(headings and headings[0] == "[Unreleased]", "CHANGELOG.md: the first heading is not [Unreleased]")
    for heading in headings[1:]:
        expect(re.fullmatch(r"\[\d+\.\d+\.\d+\] - \d{4}-\d\d-\d\d", heading), f"CHANGELOG.md: '{heading}' is not '[x.y.z] - yyyy-mm-dd'")


def yaml_of(path):
    import yaml
    return yaml.safe_load(path.read_text())


def properties_of(path):
    lines = [line for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    return dict(line.split("=", 1) for line in lines)


def manifests(folder):
    import jsonschema
    read = {"library.json": lambda p: json.loads(p.read_text()), "library.properties": properties_of, "idf_component.yml": yaml_of, "zephyr/module.yml": yaml_of}
    for name, reader in read.items():
        schema = json.loads((HERE / "schemas" / (pathlib.Path(name).name.removesuffix(".json") + ".json")).read_text())
        try:
            jsonschema.Draft7Validator(schema).validate(reader(ROOT / name))
        except jsonschema.ValidationError as e:
            raise Broken(f"{name}: {'/'.join(map(str, e.path))}: {e.message}")
    module = yaml_of(ROOT / "zephyr/module.yml")["build"]
    expect((ROOT / module["cmake"] / "CMakeLists.txt").is_file() and (ROOT / module["kconfig"]).is_file(), "zephyr/module.yml names files that are not there")


def cmake_subdirectory(folder):
    project = outside(folder / "sub")
    said = cmake_project(project, f"add_subdirectory({ROOT} spantex)")
    expect_pictures(folder, said, "add_subdirectory")
    run("cmake", "--install", project / "b", "--prefix", folder / "sub/prefix")
    expect(not list((folder / "sub").rglob("spantexConfig.cmake")), "add_subdirectory installs the library with the project")


def cmake_fetch_content(folder):
    archive = folder / "spantex.tar.gz"
    copy_of_library(folder / "release/spantex")
    with tarfile.open(archive, "w:gz") as tar:
        tar.add(folder / "release/spantex", "spantex")
    how = f'include(FetchContent)\nif(POLICY CMP0135)\ncmake_policy(SET CMP0135 NEW)\nendif()\nFetchContent_Declare(spantex URL {archive})\nFetchContent_MakeAvailable(spantex)'
    expect_pictures(folder, cmake_project(outside(folder / "fetch"), how), "FetchContent")


def cmake_installed(folder):
    prefix, _, _ = installed(folder)
    moved = folder / "moved"  # an installed tree may be moved
    shutil.copytree(prefix, moved)
    major, minor, _ = version().split(".")
    how = "find_package(spantex {} REQUIRED)"
    prefix_path = [f"-DCMAKE_PREFIX_PATH={moved}"]
    expect_pictures(folder, cmake_project(outside(folder / "found"), how.format(f"{major}.{minor}"), configure=prefix_path), "find_package")
    other = folder / "other_minor"
    other.mkdir()
    (other / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(other LANGUAGES NONE)\n" + "".join(
            f"find_package(spantex {major}.{m} QUIET)\nif(spantex_FOUND)\nmessage(FATAL_ERROR \"{version()} taken for {major}.{m}\")\nendif()\n"
            for m in (int(minor) + 1, int(minor) - 1) if m >= 0))
    run("cmake", "-S", other, "-B", other / "b", *prefix_path)


def pkg_config(folder):
    prefix, _, _ = installed(folder)
    path = str(prefix / "lib/pkgconfig")
    expect(run("pkg-config", "--modversion", "spantex", PKG_CONFIG_PATH=path).strip() == version(), "spantex.pc says another version")
    flags = run("pkg-config", "--cflags", "--libs", "spantex", PKG_CONFIG_PATH=path).split()
    program = outside(folder / "pc") / "picture"
    run(*CXX, *WARN, program.parent / "picture.cpp", "-o", program, *flags)
    expect_pictures(folder, run(program), "pkg-config")


def installed_headers(folder):
    """All of the device library, each alone, by the installed tree only; uninstall leaves nothing."""
    prefix, build, stage = installed(folder)
    include = prefix / "include/spantex"
    names = sorted(p.relative_to(include).as_posix() for p in include.rglob("*") if p.is_file())
    of_tree = sorted(p.relative_to(ROOT / "firmware").as_posix() for p in (ROOT / "firmware/spantex").rglob("*") if p.suffix in (".hpp", ".h"))
    expect([n for n in names if n.startswith("spantex/")] == of_tree, f"installed: {set(of_tree) ^ set(names)}")
    listing = "".join(f"#include <{n}>\n" for n in names if "/kernels_" not in n)
    for flags in ([*CXX, "-fsyntax-only"], ["arm-none-eabi-g++", "-std=c++20", "-mthumb", "-mcpu=cortex-m0plus", "-ffreestanding", "-fsyntax-only"]):
        source = folder / "all_headers.cpp"
        source.write_text(listing)
        run(*flags, f"-I{include}", source)
    for name in ("bin/spantex", "share/man/man1/spantex.1", "share/doc/spantex/LICENSE", "lib/pkgconfig/spantex.pc", "lib/cmake/spantex/spantexConfig.cmake"):
        expect((prefix / name).is_file(), f"make install: {name} is missing")


def headers_alone(folder):
    """Installed without a build, as docs/INTEGRATION.md says it, found by CMake and pkg-config; no library, and none asked for."""
    said = re.search(r"the headers alone, [^`]*`cmake -S \. -B (\S+) (\S+) && cmake --install \1`", (ROOT / "docs/INTEGRATION.md").read_text())
    expect(said, "docs/INTEGRATION.md does not say how to install the headers alone")
    build, prefix = folder / "headers/build", folder / "headers/prefix"
    run("cmake", "-S", ROOT, "-B", build, said[2])
    run("cmake", "--install", build, "--prefix", prefix)
    expect((prefix / "include/spantex/spantex/spantex.hpp").is_file() and not list(prefix.rglob("*.a")), "the headers alone: not installed, or not alone")
    expect("-l" not in run("pkg-config", "--libs", "spantex", PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig")), "the headers alone: spantex.pc asks for a library")
    expect_pictures(folder, cmake_project(outside(folder / "headers/found"), "find_package(spantex REQUIRED)", configure=[f"-DCMAKE_PREFIX_PATH={prefix}"]), "the headers alone")


def uninstall(folder):
    build, stage = folder / "uninstall/build", folder / "uninstall/stage"
    build.mkdir(parents=True)
    (build / "spantex").write_text("#!/bin/sh\n")
    run("make", *[f for t in ("all", "setup-build", "setup-install") for f in ("-o", t)], "install", f"B={build}", "PREFIX=/opt/st", f"DESTDIR={stage}")
    alien = stage / "opt/st/include/spantex/theirs.hpp"
    alien.write_text("")
    run("make", "uninstall", f"B={build}", "PREFIX=/opt/st", f"DESTDIR={stage}")
    left = [p for p in stage.rglob("*") if p.is_file()]
    expect(left == [alien], f"make uninstall leaves or takes too much: {left}")


def man_page(folder):
    page = re.findall(r"^\.TP\n\.B (\S+)$", (ROOT / "docs/spantex.1").read_text(), re.M)
    command = [n for p in (ROOT / "tools/spantex").glob("*.cpp") for n in re.findall(r'app\.add_subcommand\("([^"]+)"', p.read_text())]
    expect(sorted(n.replace("\\", "") for n in page) == sorted(command) and command, f"docs/spantex.1 and the command differ: {set(command) ^ set(n.replace(chr(92), '') for n in page)}")


@once
def amalgamation(folder):
    run(ROOT / "tools/amalgamate", "--out", folder / "one")
    text = (folder / "one/spantex.hpp").read_text()
    expect(not re.search(r"^\s*#\s*include\s*[<\"](spantex|hal)/", text, re.M), "the one header includes another")
    return folder / "one"


def one_header(folder):
    one = amalgamation(folder)
    project = outside(folder / "one_project")
    for compiler in (CXX[0], "clang++"):
        program = project / pathlib.Path(compiler).name
        run(compiler, *CXX[1:], *WARN, "-DSPANTEX_ONE_HEADER", f"-I{one}", project / "picture.cpp", "-o", program)
        expect_pictures(folder, run(program), f"the one header by {compiler}")


def older_standard(folder):
    """A compiler set to C++17 says first what is missing."""
    source = folder / "older.cpp"
    source.write_text("#include <spantex.hpp>\n")
    done = subprocess.run(["g++", "-std=c++17", f"-I{amalgamation(folder)}", "-fsyntax-only", source], capture_output=True, text=True)
    errors = [line for line in done.stderr.splitlines() if "error:" in line]
    expect(errors and "spantex needs C++20" in errors[0], f"with -std=c++17: {errors[:1]}")


def one_header_on_m4(folder):
    project = outside(folder / "m4")
    core = targets.named("M4")
    options = ("-DSPANTEX_ONE_HEADER", f"-I{amalgamation(folder)}")
    program = targets.build(core, project / "picture.cpp", project / "picture.elf", options=options)
    expect_pictures(folder, targets.emulate(core, program), "the one header on an emulated Cortex-M4")


def bare_metal(folder):
    raw = folder / "demo.rgb565"
    core = targets.named("M4")
    targets.emulate(core, targets.build(core, "firmware/apps/demo_m4.cpp", folder / "demo_m4.elf", options=(f'-DSPANTEX_OUT="{raw}"',)))
    expect(raw.stat().st_size == 320 * 240 * 2 and len(set(memoryview(raw.read_bytes()).cast("H"))) > 100, "demo_m4 draws no picture")


def arduino_sketch(folder, libraries):
    """The library's example by Debian's arduino-builder on a platform that compiles for this machine. What the sketch prints."""
    build = folder / "arduino_build"
    build.mkdir()
    run("arduino-builder", "-compile", "-hardware", "/usr/share/arduino-builder", "-hardware", HERE / "arduino", "-tools", "/usr/bin", "-libraries", libraries,
        "-fqbn", "outside:host:host", "-build-path", build, "-ide-version", "10819", libraries / "spantex/examples/floor/floor.ino")
    return run(build / "floor.ino.elf")


@once
def pico_checksum(folder):
    program = folder / "pico"
    run(*CXX, *WARN, *IN_TREE, "-isystem", HERE / "fakes", HERE / "pico_host.cpp", ROOT / "docs/examples/pico/main.cpp", "-o", program)
    return run(program)


def arduino(folder):
    run(ROOT / "tools/amalgamate", "--arduino", "--out", folder / "arduino/spantex")
    expect(sorted(p.name for p in (folder / "arduino/spantex").iterdir()) == ["LICENSE", "examples", "library.properties", "src"], "not the layout of a library")
    expect(properties_of(ROOT / "library.properties")["includes"] == "spantex.hpp", "library.properties: includes is not the header that there is")
    expect(arduino_sketch(folder, folder / "arduino") == pico_checksum(folder), "the Arduino example draws another floor than the Pico's")


def pico(folder):
    """The Pico's example against a display in memory; its own CMakeLists.txt with a stand-in for the SDK's functions; its code for a Cortex-M0+."""
    pico_checksum(folder)
    sdk = folder / "sdk"
    (sdk / "external").mkdir(parents=True)
    (sdk / "external/pico_sdk_import.cmake").write_text(
        f"macro(pico_sdk_init)\nadd_library(pico_stdlib INTERFACE)\ntarget_include_directories(pico_stdlib INTERFACE {HERE}/fakes)\n"
        f"target_sources(pico_stdlib INTERFACE {HERE}/pico_host.cpp)\nadd_library(hardware_spi INTERFACE)\nadd_library(hardware_dma INTERFACE)\nendmacro()\n"
        "function(pico_add_extra_outputs target)\nendfunction()\n")
    run("cmake", "-S", ROOT / "docs/examples/pico", "-B", folder / "pico_b", PICO_SDK_PATH=str(sdk))
    run("cmake", "--build", folder / "pico_b")
    expect(run(folder / "pico_b/turning_floor") == pico_checksum(folder), "by CMake another picture")
    run("arm-none-eabi-g++", "-std=c++20", "-O2", "-mthumb", "-mcpu=cortex-m0plus", "-fno-exceptions", "-fno-rtti", *WARN, *IN_TREE, "-isystem", HERE / "fakes", "-c",
        ROOT / "docs/examples/pico/main.cpp", "-o", folder / "pico.o")


def lvgl(folder):
    program = folder / "lvgl"
    run(*CXX, *WARN, *IN_TREE, "-isystem", HERE / "fakes", HERE / "lvgl_host.cpp", ROOT / "docs/examples/lvgl/perspective_image.cpp", "-o", program)
    run(program)


def exported(manifest, path):
    return any(fnmatch.fnmatch(path, pattern) or path.startswith(pattern + "/") for pattern in manifest["export"]["include"])


def platformio(folder):
    """What library.json exports, compiled with the flags and folders that it names."""
    manifest = json.loads((ROOT / "library.json").read_text())
    package = folder / "pio"
    for top in ("firmware", "hal", "docs/examples"):
        for path in (ROOT / top).rglob("*"):
            name = path.relative_to(ROOT).as_posix()
            if path.is_file() and exported(manifest, name):
                (package / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, package / name)
    build = manifest["build"]
    includes = [f"-I{package / build['includeDir']}", *(f"-I{package / f.removeprefix('-I')}" for f in build["flags"] if f.startswith("-I"))]
    for header in manifest["headers"]:
        expect(any((pathlib.Path(i[2:]) / header).is_file() for i in includes), f"library.json: no header {header}")
    expect(build["srcFilter"] == ["-<*>", "+<spantex/*.cpp>"] and build["srcDir"] == "firmware", "library.json: sources are those of firmware/spantex/")
    program = outside(folder / "pio_project") / "picture"
    run(CXX[0], *(f for f in build["flags"] if not f.startswith("-I")), "-O1", *includes, program.parent / "picture.cpp", "-o", program)
    expect_pictures(folder, run(program), "PlatformIO's package")


IDF_ARGUMENTS = ("KCONFIG KCONFIG_PROJBUILD", "SRCS SRC_DIRS EXCLUDE_SRCS INCLUDE_DIRS PRIV_INCLUDE_DIRS LDFRAGMENTS REQUIRES PRIV_REQUIRES EMBED_FILES")


def esp_idf_reads(folder, source, name):
    """CMakeLists.txt as ESP-IDF reads it: first as a script for its requirements (tools/cmake/scripts/component_get_requirements.cmake), then as a component."""
    single, multi = (a.replace(" ", ";") for a in IDF_ARGUMENTS)
    project = outside(folder / name)
    parse = f'cmake_parse_arguments(_ "" "{single}" "{multi}" "${{ARGN}}")\nif(__UNPARSED_ARGUMENTS)\nmessage(FATAL_ERROR "unknown: ${{__UNPARSED_ARGUMENTS}}")\nendif()\n'
    (project / "requirements.cmake").write_text(
        f"macro(idf_component_register)\n{parse}set(registered 1)\nreturn()\nendmacro()\n"
        f"function(read_and_tell)\nset(registered 0)\ninclude({ROOT}/CMakeLists.txt)\nset(registered ${{registered}} PARENT_SCOPE)\nendfunction()\nread_and_tell()\n"
        'if(NOT registered)\nmessage(FATAL_ERROR "no component registered")\nendif()\n')
    run("cmake", "-DESP_PLATFORM=1", "-P", project / "requirements.cmake")
    how = (f"function(idf_component_register)\n{parse}if(__SRCS)\nadd_library(component STATIC ${{__SRCS}})\ntarget_compile_features(component PRIVATE cxx_std_20)\nset(kind PUBLIC)\nelse()\n"
           "add_library(component INTERFACE)\nset(kind INTERFACE)\nendif()\nforeach(dir IN LISTS __INCLUDE_DIRS)\n"
           "target_include_directories(component ${kind} ${CMAKE_CURRENT_SOURCE_DIR}/${dir})\nendforeach()\nendfunction()\n"
           f"set(ESP_PLATFORM 1)\nset(CMAKE_CXX_STANDARD 20)\nadd_subdirectory({ROOT} spantex)")
    return cmake_project(project, how, "component", language="C CXX", source=source)


def esp_idf(folder):
    expect_pictures(folder, esp_idf_reads(folder, "picture.cpp", "idf"), "the ESP-IDF component")


def zephyr_reads(folder, source, name):
    """zephyr/CMakeLists.txt with what it calls of Zephyr's extensions (cmake/modules/extensions.cmake)."""
    project = outside(folder / name)
    how = ("add_library(zephyr_interface INTERFACE)\nfunction(zephyr_include_directories)\ntarget_include_directories(zephyr_interface INTERFACE ${ARGN})\nendfunction()\n"
           "macro(zephyr_library_named name)\nset(ZEPHYR_CURRENT_LIBRARY ${name})\nadd_library(${name} STATIC)\ntarget_link_libraries(${name} PUBLIC zephyr_interface)\nendmacro()\n"
           "macro(zephyr_library_sources)\ntarget_sources(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGN})\nendmacro()\n"
           f"set(CMAKE_CXX_STANDARD 20)\nset(CONFIG_SPANTEX y)\nadd_subdirectory({ROOT}/zephyr spantex)\nif(TARGET spantex)\ntarget_link_libraries(zephyr_interface INTERFACE spantex)\nendif()")
    return cmake_project(project, how, "zephyr_interface", language="C CXX", source=source)


def zephyr(folder):
    expect_pictures(folder, zephyr_reads(folder, "picture.cpp", "zephyr"), "the Zephyr module")


def zephyr_kconfig(folder):
    """zephyr/Kconfig below symbols named as in Zephyr's lib/cpp/Kconfig: to be had with C++20 and only then."""
    import kconfiglib
    (folder / "Kconfig").write_text("config CPP\n\tbool \"C++\"\nchoice STD_CPP\n\tprompt \"C++ standard\"\n\tdepends on CPP\n\tdefault STD_CPP11\n" + "".join(
        f"config STD_CPP{s}\n\tbool \"C++ {s}\"\n" for s in ("11", "17", "20", "2B")) + f"endchoice\nsource \"{ROOT}/zephyr/Kconfig\"\n")
    for values, wanted in (({}, 0), ({"CPP": 2}, 0), ({"CPP": 2, "STD_CPP20": 2}, 2), ({"CPP": 2, "STD_CPP2B": 2}, 2)):
        k = kconfiglib.Kconfig(str(folder / "Kconfig"), warn_to_stderr=False)
        for symbol, value in {**values, "SPANTEX": 2}.items():
            k.syms[symbol].set_value(value)
        expect(k.syms["SPANTEX"].tri_value == wanted, f"with {values} CONFIG_SPANTEX is {k.syms['SPANTEX'].tri_value}, not {wanted}")
        expect(not k.warnings, f"kconfiglib warns: {k.warnings}")


def c_interface(folder):
    """Sources in firmware/spantex/ and spantex.h come along by every way, and a program in C alone links them."""
    prefix = folder / "c_prefix"
    run("cmake", "-S", ROOT, "-B", folder / "c_build", f"-DCMAKE_INSTALL_PREFIX={prefix}", "-DCMAKE_INSTALL_LIBDIR=lib")
    run("cmake", "--build", folder / "c_build")
    run("cmake", "--install", folder / "c_build")
    for name, how, configure, language in (("c_found", "find_package(spantex REQUIRED)", [f"-DCMAKE_PREFIX_PATH={prefix}"], "C"),
                                           ("c_sub", f"add_subdirectory({ROOT} spantex)", [], "C CXX")):
        cmake_project(outside(folder / name), how, "spantex::c", configure, language, "program.c")
    flags = run("pkg-config", "--cflags", "--libs", "spantex", PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig")).split()
    run("gcc", "-std=c99", "-pedantic-errors", folder / "c_found/program.c", "-o", folder / "c_found/by_pc", *flags)
    run(folder / "c_found/by_pc")
    esp_idf_reads(folder, "program.c", "c_idf")
    zephyr_reads(folder, "program.c", "c_zephyr")


def c_interface_in_one(folder):
    one = amalgamation(folder)
    (one / "program.c").write_text(C_PROGRAM.replace("spantex/spantex.h", "spantex.h"))
    run("g++", "-std=c++20", "-O1", "-fno-exceptions", "-fno-rtti", *WARN, f"-I{one}", "-c", one / "spantex_c.cpp", "-o", one / "c.o")
    run("gcc", "-std=c99", "-pedantic-errors", f"-I{one}", one / "program.c", one / "c.o", "-o", one / "program")
    run(one / "program")


CHECKS = [c_interface, one_header, older_standard, version_agrees, manifests, man_page, cmake_subdirectory, cmake_fetch_content, cmake_installed, pkg_config, installed_headers, headers_alone, uninstall,
          one_header_on_m4, bare_metal, arduino, pico, lvgl, platformio, esp_idf, zephyr, zephyr_kconfig, c_interface_in_one]
NEEDS = ["cmake", "pkg-config", "clang++", "arm-none-eabi-g++", "qemu-system-arm", "arduino-builder"]


def outcome(check, folder):
    try:
        check(folder)
        return None
    except (Broken, SystemExit) as e:  # of tools/targets.py
        return str(e)
    except ModuleNotFoundError as e:
        return f"{e} (tools/setup packages)"


def main():
    checks = [c for c in CHECKS if not sys.argv[1:] or any(fnmatch.fnmatch(c.__name__, a) for a in sys.argv[1:])]
    if not checks:
        print(f"packaging.py: nothing is called {' '.join(sys.argv[1:])} (known: {' '.join(c.__name__ for c in CHECKS)})", file=sys.stderr)
        return 2
    missing = [n for n in NEEDS if not shutil.which(n)]
    if missing:
        print(f"packaging.py: not installed: {', '.join(missing)} (tools/setup packages)", file=sys.stderr)
        return 2
    failed = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for check, reason in zip(checks, pool.map(lambda c: outcome(c, pathlib.Path(folder)), checks)):
            failed += reason is not None
            print(f"pass {check.__name__}" if reason is None else f"{BITE}{check.__name__}: {reason}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
