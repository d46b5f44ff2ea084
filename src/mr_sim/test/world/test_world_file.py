"""Syntax of world files."""

import string

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_sim.world_file import WorldFileError, parse_world_file


def root_of(path):
    return parse_world_file(path).root


def test_properties_blocks_and_comments(write_world):
    root = root_of(
        write_world('# head\nresolution 0.02 # metres\nmodel ( name "box" size [ 1 2.5 -3e-1 ] # end )\n model ( ) )\n')
    )
    assert root.properties["resolution"].value == 0.02
    (box,) = root.children
    assert box.properties["name"].value == "box"
    assert box.properties["size"].value == (1.0, 2.5, -0.3)
    assert box.properties["size"].place.line == 3
    assert [child.kind for child in box.children] == ["model"]


def test_define_inherits_overrides_and_chains(write_world):
    root = root_of(
        write_world(
            'define a model ( color "red" size [ 1 1 1 ] model ( name "inner" ) )\n'
            'define b a ( color "blue" )\n'
            'b ( name "x" model ( name "second" ) )\nb ( size [ 2 2 2 ] )\n'
        )
    )
    first, second = root.children
    assert first.kind == "model" and first.word == "b"
    assert first.properties["color"].value == "blue"
    assert first.properties["size"].value == (1.0, 1.0, 1.0)
    assert [child.properties["name"].value for child in first.children] == ["inner", "second"]
    assert second.properties["size"].value == (2.0, 2.0, 2.0)
    assert len(second.children) == 1, "an instance must not change the definition it is made from"


def test_include_is_relative_to_its_file_and_brings_definitions(write_world, tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "outer.inc").write_text('include "inner.inc"\n')
    (tmp_path / "sub" / "inner.inc").write_text("define thing model ( size [ 1 1 1 ] )\n")
    root = root_of(write_world('include "sub/outer.inc"\nthing ( )\n'))
    assert root.children[0].properties["size"].place.file.endswith("inner.inc")


def test_files_are_looked_up_as_stage_does(write_world, tmp_path, monkeypatch):
    """Beside the world file, then beside the file that names them, then by their bare name in STAGEPATH."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "outer.inc").write_text('include "inner.inc"\n')
    (tmp_path / "sub" / "inner.inc").write_text("resolution 1\n")
    text = 'include "sub/outer.inc"\n'
    assert root_of(write_world(text)).properties["resolution"].value == 1
    assert root_of(write_world(text, inner_inc="resolution 2")).properties["resolution"].value == 2
    shared = tmp_path / "shared"
    shared.mkdir()
    (shared / "far.inc").write_text("resolution 3\n")
    monkeypatch.setenv("STAGEPATH", f"/nowhere:{shared}")
    assert root_of(write_world('include "elsewhere/far.inc"')).properties["resolution"].value == 3
    assert root_of(write_world(f'include "{shared}/far.inc"')).properties["resolution"].value == 3


def test_robots_of_the_project_are_found_last(write_world, tmp_path, monkeypatch):
    monkeypatch.delenv("STAGEPATH", raising=False)
    text = 'include "pioneer.inc"\npioneer ( name "a" )\n'
    assert root_of(write_world(text)).children[0].properties["size"].place.file.endswith("worlds/pioneer.inc")
    (tmp_path / "pioneer.inc").write_text("define pioneer position ( size [ 1 1 1 ] )\n")
    assert root_of(write_world(text)).children[0].properties["size"].value == (1.0, 1.0, 1.0)


def test_definition_may_name_what_is_defined_later(write_world):
    root = root_of(write_world("define a model ( b ( ) )\ndefine b model ( size [ 1 1 1 ] )\na ( )"))
    assert root.children[0].children[0].word == "b"
    assert root.children[0].children[0].properties["size"].value == (1.0, 1.0, 1.0)


def test_definition_may_have_the_name_of_a_block(write_world):
    root = root_of(write_world("define block model ( size [ 1 1 1 ] )\nblock ( )"))
    assert (root.children[0].kind, root.children[0].word) == ("model", "block")


def test_first_definition_holds_and_another_one_is_told(write_world):
    file = parse_world_file(write_world("define a model ( mass 1 )\ndefine a model ( mass 2 )\na ( )"))
    assert file.root.children[0].properties["mass"].value == 1
    (remark,) = file.remarks
    assert remark.place.line == 2 and '"a" is defined already' in remark.text
    again = "define a model ( mass 1 )\n"
    assert parse_world_file(write_world(again + again)).remarks == ()


def test_words_with_an_index(write_world):
    root = root_of(
        write_world("model ( spose[0] [ 1 2 3 ] block[0].points 4 block[0].point[1] [ 1 2 ] size[ 1 1 1 ] )")
    )
    assert set(root.children[0].properties) == {"spose[0]", "block[0].points", "block[0].point[1]", "size"}


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ('model (\n name "x\n)', 2, "closing quote"),
        ("resolution 1.2.3", 1, 'bad number "1.2.3"'),
        ("resolution nan", 1, "needs a number"),
        ("resolution 1e999", 1, 'bad number "1e999"'),
        ("model ( size [ 1 two 3 ] )", 1, 'bad number "two"'),
        ("model ( size [ 1 2 3 )", 1, 'bad number ")"'),
        ("model ( size [ 1 2 3", 1, "never closed"),
        ("\nmodel ( pose [ 0 0 0 0 ]\n", 2, 'block of "model" is never closed'),
        ("model ( ) )", 1, 'unexpected ")"'),
        ("pioneer ( )", 1, 'unknown model "pioneer"'),
        ("define a", 1, "define needs"),
        ("define model model ( )\nmodel ( )", 1, '"model" is defined by itself'),
        ("define a b ( )\ndefine b a ( )\na ( )", 2, '"a" is defined by itself'),
        ("define a model (", 1, 'block of "a" is never closed'),
        ("positoin ( )", 1, 'unknown model "positoin", did you mean "position"?'),
        ("define rover model ( )\nrovre ( )", 2, 'did you mean "rover"?'),
        ("include pioneer.inc", 1, "file name in quotes"),
        ('\n\ninclude "missing.inc"', 3, "no such file"),
        ("resolution", 1, "has no value"),
        ("[ 1 2 ]", 1, "expected a word"),
        ("resolution )", 1, "needs a number, a string or a tuple"),
    ],
)
def test_faults_name_file_line_and_word(write_world, text, line, message):
    with pytest.raises(WorldFileError) as caught:
        parse_world_file(write_world(text))
    assert f"test.world:{line}: " in str(caught.value)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_fault_in_an_included_file_names_that_file(write_world):
    with pytest.raises(WorldFileError, match=r"robot\.inc:2: .*\"12x\""):
        parse_world_file(write_world('include "robot.inc"', robot_inc="\nresolution 12x\n"))


def test_include_cycle(write_world):
    with pytest.raises(WorldFileError, match=r"b\.inc:1: include cycle: a\.inc -> b\.inc -> a\.inc"):
        parse_world_file(write_world('include "a.inc"', a_inc='include "b.inc"', b_inc='include "a.inc"'))


def test_definitions_that_grow_without_end_are_refused(write_world):
    """A few lines that mean a million million models: the reader went on until somebody ended it."""
    names = [f"a{number}" for number in range(12)]
    doubling = [f"define {one} model ( {f'{two} ( ) ' * 10})" for one, two in zip(names, names[1:], strict=False)]
    with pytest.raises(WorldFileError, match=r"test\.world:\d+: there are more than 100000 blocks"):
        parse_world_file(write_world("\n".join([*doubling, "define a11 model ( )", "a0 ( )"])))


def test_files_that_include_one_another_without_end_are_refused(write_world):
    files = {f"a{number}_inc": f'include "a{number + 1}.inc"\n' * 3 for number in range(10)}
    with pytest.raises(WorldFileError, match="more than 1000 files are included"):
        parse_world_file(write_world('include "a0.inc"', a10_inc="", **files))


def test_missing_and_unreadable_world(tmp_path):
    with pytest.raises(WorldFileError, match="no such file"):
        parse_world_file(tmp_path / "none.world")
    with pytest.raises(WorldFileError, match="cannot read"):
        parse_world_file(tmp_path)
    (tmp_path / "binary.world").write_bytes(b"\x89PNG\xff\xfe\x00")
    with pytest.raises(WorldFileError, match="cannot read"):
        parse_world_file(tmp_path / "binary.world")


names = st.text(string.ascii_lowercase + "_", min_size=1, max_size=8).filter(lambda n: n not in ("include", "define"))
numbers = st.floats(-1e6, 1e6).map(lambda x: round(x, 6))
texts = st.text(string.ascii_letters + " ./", max_size=10)
values = st.one_of(numbers, texts, st.lists(numbers, max_size=8).map(tuple))


def _written(value: object) -> str:
    if isinstance(value, tuple):
        return "[ " + " ".join(map(repr, value)) + " ]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


@given(properties=st.dictionaries(names, values, max_size=6), spacing=st.sampled_from([" ", "\n", "\t # x\n"]))
def test_what_is_written_is_read(write_world, properties, spacing):
    text = spacing.join(f"{word} {_written(value)}" for word, value in properties.items())
    root = root_of(write_world(f"model ({spacing}{text}{spacing})"))
    assert {word: entry.value for word, entry in root.children[0].properties.items()} == properties


@given(text=st.lists(st.sampled_from([*'abm ()[]"#\n0.-e', "model (", "define ", "include ", " 1 "])).map("".join))
def test_any_text_is_parsed_or_refused_with_one_line(write_world, text):
    try:
        parse_world_file(write_world(text))
    except WorldFileError as error:
        assert "test.world" in str(error) and "\n" not in str(error)


def test_a_byte_order_mark_is_no_part_of_the_first_word(tmp_path):
    path = tmp_path / "marked.world"
    path.write_bytes("\ufeffresolution 0.1\n".encode())
    assert parse_world_file(path).root.properties.keys() == {"resolution"}
