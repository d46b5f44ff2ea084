"""What the page makes of updates: places, links, clocks, bounds. Needs node."""

import json

import pytest
from test_document import node

from mr_page.stream import TOLD

MOST = TOLD["auctions"]  # of a robot, and of the team

SCRIPT = """
globalThis.document = { createElement: () => ({ getContext: () => ({}) }) };
const { Live } = await import("./live.js");
const live = new Live({});
const updates = %s;
for (const update of updates) live.apply({ anew: [], robots: {}, maps: [], tiles: [], ...update });
console.log(JSON.stringify(%s));
"""


def played(updates, expression):
    return node(SCRIPT % (json.dumps(updates), expression))


def told(name, **values):
    return {"robots": {name: {"values": values}}}


def merger(**poses):
    """{robot: its pose or None}."""
    entries = [{"robot": name, "placed": bool(pose), "why": "", "via": "", "pose": pose or [0, 0, 0], "confidence": 1}
               for name, pose in poses.items()]  # fmt: skip
    return {"robots": entries, "wants_to_meet": []}


def test_robots_stand_where_their_maps_are_placed():
    updates = [
        told(
            "robot_0",
            pose=[1, 0, 0],
            merger=merger(robot_1=[5, 0, 1.5707963], robot_2=None),
            about={"start": [9, 9, 0]},
        ),
        told("robot_1", pose=[2, 0, 0], about={"start": [4, 0, 0]}),
        told("robot_2", pose=[3, 0, 0]),
    ]
    poses = "live.scene(0, {}).robots.map((r) => r.pose && [r.pose.x, r.pose.y].map((v) => Math.round(100 * v) / 100))"
    assert played(updates, poses) == [[1, 0], [5, 2], None]
    assert played(updates, poses.replace("scene(0", "scene(-1")) == [[10, 9], [6, 0], None]


def test_the_map_that_is_made_of_most_maps_is_shown_until_somebody_chooses():
    here, away = [0, 0, 0], [1, 1, 0]
    first = [
        told("robot_0", merger=merger(robot_0=here, robot_1=None, robot_2=None), decision={"area": 90}),
        told("robot_1", merger=merger(robot_0=None, robot_2=away), decision={"area": 40}),
        told("robot_2", merger=merger(robot_0=None, robot_1=away), decision={"area": 60}),
    ]
    shown = "live.mostMerged('{}')"
    assert played(first[:1], shown.format("")) == ""
    assert played(first, shown.format("")) == "robot_2", "of two the one that knows most"
    assert played(first, shown.format("robot_1")) == "robot_1", "it does not turn for an area alone"
    both = told("robot_0", merger=merger(robot_1=away, robot_2=away))
    assert played([*first, both], shown.format("robot_1")) == "robot_0"
    assert played([*first, both, told("robot_0", lost=True)], shown.format("robot_0")) == "robot_2"


def test_robots_of_which_only_others_tell_have_a_place():
    updates = [told("robot_1", pose=[0, 0, 0], merger=merger(robot_10=[1, 1, 0]), peers={"robot_10": [3, 4]})]
    assert played(updates, "live.robots.map((r) => [r.name, r.told])") == [["robot_1", True], ["robot_10", False]]
    assert played(updates, "live.scene(0, {}).robots[1].pose") == {"x": 3, "y": 4, "yaw": None, "silent": False}


def test_what_others_have_told_over_the_radio_is_shown():
    heard = {"state": "returning", "text": "drives home", "in_reach": True, "area": 90}
    updates = [told("base", about={"base": True}, team={"text": "", "robots": {"robot_7": heard}})]
    assert played(updates, "live.robots.map((r) => [r.name, r.told, r.stage])")[1] == ["robot_7", False, "returning"]


def test_a_link_has_the_worse_loss_of_both_directions():
    def links(**losses):
        return {
            "robots": [],
            "links": [{"robot": name, "two_way": True, "loss": loss} for name, loss in losses.items()],
        }

    updates = [told("a", network=links(b=0.1)), told("b", network=links(a=0.3, stranger=0.9))]
    assert played(updates, "live.links()") == [{"a": 0, "b": 1, "both": True, "loss": 0.3}]
    assert played([*updates, told("b", lost=True)], "live.links()") == [{"a": 0, "b": 1, "both": True, "loss": 0.1}]


def test_other_clocks_are_set():
    updates = [
        told("base", time=1700000050.0, begin=1700000000.0, about={"base": True}),
        told("robot_0", time=60.0, begin=12.0),
        {"robots": {"base": {"streams": {"events": [0, [[1700000020.0, "link", "hears", ""]]]}}}},
    ]
    assert played(updates, "[live.begin, live.now, live.robots[0].stream('events')[0][0]]") == [10, 60, 30]


def test_streams_are_told_on_where_they_stopped():
    def events(first, count):
        return {
            "robots": {
                "a": {"streams": {"log": [first, [[i, "error", "n", "t"] for i in range(first, first + count)]]}}
            }
        }

    found = played([events(0, 3), events(3, 2)], "[live.robots[0].since('log', 3), live.robots[0].since('log', 5)]")
    assert [item[0] for item in found[0]["items"]] == [3, 4] and found[1] == {"items": [], "end": 5}


def auctioned(name, *held):
    return {"robots": {name: {"streams": {"auctions": [0, [[at, 1, 7, offers] for at, offers in held]]}}}}


def test_the_newest_auctions_of_the_team_come_first_and_are_bounded():
    updates = [
        told("base", time=1700000050.0, about={"base": True}),
        told("a", time=60.0),
        auctioned("a", *((float(at), []) for at in range(0, 100, 2))),
        auctioned("b", *((float(at), []) for at in range(1, 61, 2))),
    ]
    found = played(updates, "[live.robots, [live.robots[0]]].map((r) => live.auctions(r).map((a) => [a.robot, a.at]))")
    every = sorted([[at, "ab"[at % 2]] for at in range(100) if at < 61 or at % 2 == 0], reverse=True)
    assert found[0] == [[name, at] for at, name in every[:MOST]]
    assert found[1] == [["a", at] for at in range(98, -1, -2)][:MOST]


def test_clusters_of_an_auction_lie_where_the_map_of_the_auctioneer_is_placed():
    offers = [[1.0, 0.0, {"a": 2.0}, "b"], [2.0, 0.0, {}, ""]]
    updates = [
        told("a", merger=merger(b=[5, 0, 1.5707963], c=None)),
        auctioned("b", (3.0, offers)),
        auctioned("c", (4.0, offers)),
    ]
    shown = "live.scene(0, {}, live.auctions([live.robots[%d]])[0]).auction"
    assert played(updates, shown % 1)["clusters"] == [pytest.approx([5, 1, 1]), pytest.approx([5, 2, -1])]
    assert played(updates, shown % 2) is None and played(updates, "live.scene(0, {}).auction") is None


def test_a_run_that_begins_anew_forgets_the_former():
    updates = [told("a", x=1), {"anew": ["a"], "robots": {"a": {"values": {"y": 2}}}}]
    assert played(updates, "live.robots.map((r) => r.values)") == [{"y": 2}]


TILE = "Object.assign(new Uint8Array(1024), [%d])"
MOMENT = '{ anew: %s, robots: { a: { values: { time: %d } } }, maps: [["a", "local", 0.05, 0, 0, 0]], tiles: [%s] }'


def moment(time, *tiles, anew=("a",)):
    """`tiles`: column and first octet of each."""
    told = ", ".join(
        f'{{ robot: "a", kind: "local", row: 0, column: {column}, octets: {TILE % octet} }}' for column, octet in tiles
    )
    return MOMENT % (json.dumps(anew), time, told)


def test_the_past_is_shown_whole_and_paints_only_what_differs():
    """Tiles that are another one, gone, the same and new; a robot that was not there."""
    script = SCRIPT % (
        "[]",
        "(() => {"
        f"live.become({moment(1, (0, 1), (1, 2), (2, 3), anew=('a', 'b'))}); const map = live.robots[0].maps.local;"
        f"const before = map.version; live.become({moment(2, (0, 9), (2, 3), (3, 4))});"
        "return [live.robots.map((r) => [r.name, r.values.time]), map === live.robots[0].maps.local,"
        " [0, 1, 2, 3].map((c) => map._tiles.get(`0 ${c}`).octets[0]), map.version - before]; })()",
    )
    assert node(script) == [[["a", 2]], True, [9, 0, 3, 4], 3]


def test_numbers_that_are_rounded_to_zero_have_no_sign():
    script = """const { fixed, kilobits } = await import("./dom.js");
    console.log(JSON.stringify([fixed(-0.001, 2), fixed(-1.25, 1), fixed(0, 1), kilobits(100), kilobits(5000)]));"""
    assert node(script) == ["0.00", "-1.3", "0.0", "0.8", "40"]


SILENT = """
let now = 0, watch = null;
const sockets = [], changes = [], sent = [], later = [];
globalThis.performance = { now: () => now };
globalThis.window = { location: { protocol: "http:", host: "robot" } };
globalThis.setInterval = (look) => { watch = look; };
globalThis.setTimeout = (open) => later.push(open);
globalThis.WebSocket = class {
  static OPEN = 1;
  constructor() { this.readyState = 0; sockets.push(this); }
  send(text) { sent.push(text); }
  close() { this.readyState = 2; this.onclose?.(); }
};
const { Connection } = await import("./connection.js");
const connection = new Connection({ answered() {}, changed: (is) => changes.push(is) });
const open = () => { sockets.at(-1).readyState = 1; sockets.at(-1).onopen(); };
const after = (ms) => { now += ms; watch(); };
open();
after(4000);
sockets[0].onmessage({ data: "{}" });
after(4000);
const alive = [connection.order("a", "pause", ""), ...changes];
after(2000);
const lost = [connection.order("a", "pause", ""), ...changes, sockets[0].readyState];
later.pop()();
open();
console.log(JSON.stringify({ alive, lost, again: [sockets.length, later.length, ...changes], sent: sent.length }));
"""


def test_a_connection_that_is_silent_is_lost_and_sends_nothing():
    """A browser took minutes to see that a link was dead, and meanwhile orders went nowhere."""
    assert node(SILENT) == {
        "alive": [True, True], "lost": [False, True, False, 2], "again": [2, 0, True, False, True], "sent": 3,
    }  # fmt: skip
