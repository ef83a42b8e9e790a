// Written by scripts/frontend types from linkwork.viewer.live.palette: change that.

/** One thing to fill in: a key of a table, what it is for, and how it is entered. `entry`: `text`, `number`, `flag`, `choice` of some `words`; the name of a `point`, `link` or `slider`; several `points` or `links`; `numbers` in one line; `lines` of numbers, or of words that are `named` in this order. */
export interface PaletteField {
  readonly name: string;
  readonly doc: string;
  readonly entry: string;
  readonly required: boolean;
  readonly words: readonly string[];
  readonly named: readonly string[];
}

/** A kind of part: the table of the file where it belongs. */
export interface PalettePart {
  readonly table: string;
  readonly title: string;
  readonly doc: string;
  readonly fields: readonly PaletteField[];
}

export const PALETTE: readonly PalettePart[] = [
  {
    "table": "slots",
    "title": "Pin in slot",
    "doc": "Pin in slot: a point moves along a line of another link",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the displacement, zero at the first point of the line",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "point",
        "doc": "The pin: a point of another link",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "on",
        "doc": "The link with the slot",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "line",
        "doc": "Two points of that link; positive from first to second",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "sliders",
    "title": "Slider",
    "doc": "A link slides along a line of another without turning",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the displacement, zero at the first point of the line",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "link",
        "doc": "The link that slides without turning",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "points",
        "doc": "Two points of the sliding link on the line, or one point and angle",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "on",
        "doc": "The link along which it slides",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "line",
        "doc": "Two points of that link; positive from first to second",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "offset",
        "doc": "Distance of the points from the line, positive to its left",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "angle",
        "doc": "With one point: the angle from the line to the sliding link",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "cylinders",
    "title": "Cylinder",
    "doc": "A link of variable length between two points",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the variable length",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "between",
        "doc": "The two points it connects",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "welds",
    "title": "Weld",
    "doc": "Two links that share a point and turn together",
    "fields": [
      {
        "name": "links",
        "doc": "Two links that share a point",
        "entry": "links",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "angle",
        "doc": "From the first link's direction to the second's",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "gears",
    "title": "Gear pair",
    "doc": "Two wheels in mesh, external or internal, on a common arm",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the gear pair",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "wheels",
        "doc": "The two links that turn",
        "entry": "links",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "centers",
        "doc": "The points at which they turn",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "arm",
        "doc": "The link with both centres; default ground",
        "entry": "link",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "radii",
        "doc": "Pitch radii",
        "entry": "numbers",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "teeth",
        "doc": "Numbers of teeth, instead of radii",
        "entry": "numbers",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "phase",
        "doc": "Angle of the second wheel where the first one's is zero",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "internal",
        "doc": "The larger wheel is a ring around the smaller one",
        "entry": "flag",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "belts",
    "title": "Belt or chain",
    "doc": "A belt or chain around two wheels, open or crossed",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the belt or chain",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "wheels",
        "doc": "The two links that turn",
        "entry": "links",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "centers",
        "doc": "The points at which they turn",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "arm",
        "doc": "The link with both centres; default ground",
        "entry": "link",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "radii",
        "doc": "Pitch radii",
        "entry": "numbers",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "teeth",
        "doc": "Numbers of teeth, instead of radii",
        "entry": "numbers",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "phase",
        "doc": "Angle of the second wheel where the first one's is zero",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "crossed",
        "doc": "The belt crosses itself: the wheels turn in opposite directions",
        "entry": "flag",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "racks",
    "title": "Rack and pinion",
    "doc": "A rack that slides and the pinion that drives it",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the rack and pinion",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "pinion",
        "doc": "The link that turns",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "center",
        "doc": "The point at which it turns",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "slider",
        "doc": "The slider of the rack",
        "entry": "slider",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "radius",
        "doc": "Pitch radius of the pinion",
        "entry": "number",
        "required": true,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "rolling",
    "title": "Rolling wheel",
    "doc": "A wheel that rolls without slipping",
    "fields": [
      {
        "name": "name",
        "doc": "Displacement of the point of contact along the line, or angle of the line of centres",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "wheel",
        "doc": "The link that rolls",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "center",
        "doc": "Its centre",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "radius",
        "doc": "Its radius",
        "entry": "number",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "on",
        "doc": "The link on which it rolls; default ground",
        "entry": "link",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "line",
        "doc": "Two points of that link: it rolls along this line",
        "entry": "points",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "circle",
        "doc": "Or the centre of the circle on which it rolls",
        "entry": "point",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "circle_radius",
        "doc": "The radius of that circle",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "inside",
        "doc": "The smaller of wheel and circle is inside the larger one",
        "entry": "flag",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "cams",
    "title": "Cam",
    "doc": "A cam and its follower",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the cam",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "cam",
        "doc": "The link that turns",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "center",
        "doc": "The point about which it turns",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "slider",
        "doc": "The slider that it moves",
        "entry": "slider",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "link",
        "doc": "Or the oscillating link that it moves",
        "entry": "link",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "pivot",
        "doc": "With link: the point about which it oscillates",
        "entry": "point",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "point",
        "doc": "With link: its knife edge, the centre of its roller or the end of its face",
        "entry": "point",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "contact",
        "doc": "Kind of the follower; default knife",
        "entry": "choice",
        "required": false,
        "words": [
          "knife",
          "roller",
          "flat"
        ],
        "named": []
      },
      {
        "name": "radius",
        "doc": "Radius of the roller",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "base",
        "doc": "Radius of the base circle, with segments",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "start",
        "doc": "Angle of the cam at which the segments begin; default 0",
        "entry": "number",
        "required": false,
        "words": [],
        "named": []
      },
      {
        "name": "segments",
        "doc": "Motion of the follower in one turn of the cam",
        "entry": "lines",
        "required": false,
        "words": [],
        "named": [
          "law",
          "over",
          "lift"
        ]
      },
      {
        "name": "profile",
        "doc": "Or the outline, in the cam's frame about its centre",
        "entry": "lines",
        "required": false,
        "words": [],
        "named": [
          "x",
          "y"
        ]
      }
    ]
  },
  {
    "table": "curves",
    "title": "Curve",
    "doc": "A point moves along a curve of another link",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the coordinate along the curve",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "point",
        "doc": "The point that moves along it, of another link",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "on",
        "doc": "The link with the curve",
        "entry": "link",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "origin",
        "doc": "The point of that link from which coordinates are measured",
        "entry": "point",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "through",
        "doc": "Points of the curve in that link's own frame",
        "entry": "lines",
        "required": true,
        "words": [],
        "named": [
          "x",
          "y"
        ]
      },
      {
        "name": "closed",
        "doc": "Whether the curve is closed",
        "entry": "flag",
        "required": false,
        "words": [],
        "named": []
      }
    ]
  },
  {
    "table": "springs",
    "title": "Spring",
    "doc": "A spring between two points; drawn, without constraint",
    "fields": [
      {
        "name": "name",
        "doc": "Name of the spring",
        "entry": "text",
        "required": true,
        "words": [],
        "named": []
      },
      {
        "name": "between",
        "doc": "The two points it connects",
        "entry": "points",
        "required": true,
        "words": [],
        "named": []
      }
    ]
  }
];
