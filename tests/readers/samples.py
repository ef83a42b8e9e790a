"""Small files of other programs, written for these tests: mostly one four-bar."""

from __future__ import annotations

import io
import json
import zipfile

__all__ = ["GEOGEBRA", "SAMPLES", "dxf_text", "packed"]

PMKS_LINES = """\
ground,input,R,0,0,0,ffft
input coupler R 24 32 0 ffff
coupler,follower,R,120,64
follower,ground,R,100,0
coupler,R,70,90
"""
PMKS_SLIDE = """\
ground,input,R,0,0
input,coupler,R,0,10
coupler,output,R,12,2
ground,output,P,12,0,0
"""
PMKS_QUICK_RETURN = """\
ground,input,R,0,0
lever input,RP,2,1,90
lever,ground,R,2,-6
"""
PMKS_FIRST = (
    "https://pmksplus.mech.website/?j=A,0,0,AB,R,t,0,0.1,t,%0AB,3,4,AB%7CBC,R,f,0,0.1,f,%0A"
    "C,12,0,BC,P,t,0,0.1,f,%0A&l=AB,1,1,1.5,2,A%7CB,,l,0,0&f=F1,AB,1,1,2,2,t,true,0,5&s=10,false,cm"
)
_POINTS = {"A0": (0, 0), "A": (24, 32), "B": (120, 64), "B0": (100, 0)}
PYLINKAGE = {
    "name": "four-bar",
    "joints": [
        {"id": name, "type": "ground" if name.endswith("0") else "revolute", "position": at}
        for name, at in _POINTS.items()
    ]
    + [
        {
            "id": "P",
            "type": "tracker",
            "position": [70, 90],
            "ref_joint1_id": "A",
            "ref_joint2_id": "B",
            "distance": 1.0,
            "angle": 0.5,
        }
    ],
    "links": [
        {"id": "ground", "type": "ground", "joints": ["A0", "B0"]},
        {"id": "crank", "type": "driver", "joints": ["A", "A0"], "motor_joint": "A0",
         "angular_velocity": 0.1},
        {"id": "coupler", "type": "link", "joints": ["A", "B"]},
        {"id": "rocker", "type": "link", "joints": ["B0", "B"]},
    ],
    "ground": "ground",
}  # fmt: skip
PYLINKAGE_PARENTS = {
    "name": "four-bar of joints",
    "joints": [
        {"type": "Static", "name": "A0", "x": 0, "y": 0},
        {"type": "Crank", "name": "A", "x": 25, "y": 31, "joint0": {"ref": "A0"},
         "distance": 40, "angle": 0.1},
        {"type": "Revolute", "name": "B", "x": 120, "y": 60, "joint0": {"ref": "A"},
         "joint1": {"inline": True, "type": "Static", "x": 100, "y": 0, "name": "B0"},
         "distance0": 120, "distance1": 80},
        {"type": "Fixed", "name": "P", "x": 90, "y": 90, "joint0": {"ref": "A"},
         "joint1": {"ref": "B"}, "distance": 50, "angle": 0.5},
        {"type": "Prismatic", "name": "S", "x": 200, "y": 0, "joint0": {"ref": "B"},
         "joint1": {"ref": "A0"}, "joint2": {"ref": "B0"}, "revolute_radius": 110},
    ],
    "solve_order": ["A0", "A", "B", "P", "S"],
}  # fmt: skip
LINKAGE2 = """\
<linkage2>
\t<program zoom="1" units="Millimeters"/>
\t<connector anchor="true" input="true" rpm="15" x="0" y="0" id="0" name="O"/>
\t<connector x="24" y="32" id="1"/>
\t<connector x="120" y="64" id="2"/>
\t<connector anchor="true" x="100" y="0" id="3"/>
\t<connector draw="true" x="70" y="90" id="4"/>
\t<connector x="110" y="32" id="5" slider="true">
		<slidelimit id="2"/><slidelimit id="3"/></connector>
\t<connector anchor="true" x="200" y="0" id="6"/>
\t<connector x="5" y="5" id="7" layer="1"/>
\t<Link id="0"><connector id="0"/><connector id="1"/></Link>
\t<Link id="1" name="coupler"><connector id="1"/><connector id="2"/><connector id="4"/></Link>
\t<Link id="2"><connector id="2"/><connector id="3"/></Link>
\t<Link id="3"><connector id="5"/><connector id="6"/></Link>
\t<Link id="4" gear="true" fastenlink="0"><connector id="0"/></Link>
\t<Link id="5" gear="true"><connector id="3"/></Link>
\t<ratios><ratio type="gears"><link id="4" size="2"/><link id="5" size="1"/></ratio></ratios>
\t<selected/>
</linkage2>
"""
PYSLVS = (
    "M[J[R, color[Green], P[0.0, 0.0], L[ground, crank]],\n"
    "  J[R, color[Green], P[24, 32], L[crank, coupler]],\n"
    "  J[R, P[120, 64], L[coupler, rocker]], # a comment\n"
    "  J[R, color[(1, 2, 3)], P[70, 90], L[coupler]],\n"
    "  J[R, P[100, 0], L[ground, rocker]]]\n"
)
GEOGEBRA = """\
<?xml version="1.0" encoding="utf-8"?>
<geogebra format="5.0"><construction title="Four-bar" author="" date="">
<element type="point" label="A0"><coords x="0" y="0" z="1"/></element>
<element type="point" label="B0"><coords x="200" y="0" z="2"/></element>
<element type="numeric" label="a"><value val="40"/></element>
<element type="numeric" label="b"><value val="120"/></element>
<element type="numeric" label="c"><value val="80"/></element>
<command name="Circle"><input a0="A0" a1="a"/><output a0="k1"/></command>
<element type="conic" label="k1"/>
<command name="Point"><input a0="k1"/><output a0="A"/></command>
<element type="point" label="A"><coords x="24" y="32" z="1"/></element>
<command name="Circle"><input a0="A" a1="b"/><output a0="k2"/></command>
<element type="conic" label="k2"/>
<command name="Circle"><input a0="B0" a1="c"/><output a0="k3"/></command>
<element type="conic" label="k3"/>
<command name="Intersect"><input a0="k2" a1="k3" a2="1"/><output a0="B"/></command>
<element type="point" label="B"><coords x="139.52250" y="69.55" z="1"/><trace val="true"/></element>
<command name="Segment"><input a0="A" a1="B"/><output a0="f"/></command>
<element type="segment" label="f"><javascript val="alert(1)"/></element>
<command name="Midpoint"><input a0="f"/><output a0="M"/></command>
<element type="point" label="M"><coords x="81.76125" y="50.775" z="1"/></element>
<command name="Circle"><input a0="B" a1="b"/><output a0="k4"/></command>
<command name="Intersect"><input a0="k4" a1="xAxis"/><output a0="S" a1="T"/></command>
<element type="point" label="S"><coords x="237.31" y="0" z="1"/></element>
<element type="text" label="t1"/>
<expression label="Q" exp="A + (1, 0)" type="point"/>
<element type="point" label="Q"><coords x="25" y="32" z="1"/></element>
</construction></geogebra>
"""
MJCF = """\
<mujoco model="four-bar">
  <compiler angle="degree"/>
  <default><joint axis="0 -1 0"/></default>
  <worldbody>
    <body name="crank"><joint name="drive"/>
      <geom type="capsule" size="0.01" fromto="0 0 0 0.024 0 0.032"/>
      <body name="coupler" pos="0.024 0 0.032"><joint name="A" type="hinge"/>
        <site name="tip" pos="0.096 0 0.032"/></body></body>
    <body name="rocker" pos="0.1 0 0" euler="0 0 0"><joint name="B0"/>
      <inertial pos="0 0 0" mass="1"/></body>
  </worldbody>
  <equality><connect name="B" body1="coupler" body2="rocker" anchor="0.096 0 0.032"/></equality>
  <actuator><motor joint="drive"/></actuator>
</mujoco>
"""
URDF = """\
<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.1 0 0"/><mass value="1"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0.2 0 0"/><mass value="1"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><origin xyz="0 0 0.5" rpy="1.5707963267948966 0 0"/>
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><origin xyz="0.4 0 0"/><parent link="upper"/>
    <child link="lower"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="-2" offset="0.5"/>
    <limit lower="-2" upper="1" effort="1" velocity="1"/></joint>
  <joint name="flange" type="fixed"><origin xyz="0.3 0 0"/><parent link="lower"/>
    <child link="tool"/></joint>
  <transmission name="t"/>
</robot>
"""


def dxf_text() -> str:
    """A drawing: four circles, a polyline with a corner, lines, a text, a block."""
    pairs: list[tuple[int, object]] = [
        (0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC"),
        (0, "SECTION"), (2, "ENTITIES"),
    ]  # fmt: skip
    circles = {
        (0, 0): "Ground",
        (24, 32): "0",
        (120, 64): "0",
        (100, 0): "GROUND",
        (70, 90): "trace",
    }
    for (x, y), layer in circles.items():
        pairs += [(0, "CIRCLE"), (8, layer), (10, x), (20, y), (40, 3)]
    pairs += [(0, "LINE"), (8, "input"), (10, 0), (20, 0), (11, 24), (21, 32)]
    pairs += [(0, "LWPOLYLINE"), (8, "0"), (90, 3), (70, 1)]
    for x, y in ((24, 32), (120, 64), (70, 90)):
        pairs += [(10, x), (20, y)]
    # drawn to the rims of the circles
    pairs += [(0, "LINE"), (8, "0"), (10, 119), (20, 62), (11, 100.5), (21, 2)]
    pairs += [(0, "LINE"), (8, "0"), (10, 500), (20, 0), (11, 600), (21, 0)]
    pairs += [(0, "TEXT"), (8, "0"), (1, "A0"), (10, 0), (20, 0), (0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:3d}\n{value}\n" for code, value in pairs)


def packed(text: str, name: str = "geogebra.xml") -> bytes:
    """A ZIP file with one entry."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as into:
        into.writestr(name, text)
    return file.getvalue()


#: File names with their contents: at least one of every format.
SAMPLES: dict[str, bytes] = {
    "lines.pmks": PMKS_LINES.encode(),
    "slide.pmks": PMKS_SLIDE.encode(),
    "quick-return.txt": PMKS_QUICK_RETURN.encode(),
    "first.pmks": PMKS_FIRST.encode(),
    "mechanism.json": json.dumps(PYLINKAGE).encode(),
    "parents.json": json.dumps(PYLINKAGE_PARENTS, indent=1).encode(),
    "bar.linkage2": LINKAGE2.encode(),
    "bar.pyslvs": PYSLVS.encode(),
    "bar.ggb": packed(GEOGEBRA),
    "bar.xml": GEOGEBRA.encode(),
    "bar.dxf": dxf_text().encode(),
    "bar.mjcf": MJCF.encode(),
    "arm.urdf": URDF.encode(),
}
