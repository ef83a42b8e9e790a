"""The operations of path following: aim, predict, attempt, resize.

They are plain functions of numbers. NumPy's paths call them as they are, Numba compiles them for
lanes, and a graphics card runs them in its threads; so the package knows neither NumPy's solvers
nor Numba. They differ in how an attempt corrects and judges a prediction.

These loops step along a path, each for a reason:

* :func:`linkwork.marching.loop.march`: one path, one step after the other. Branches, proved
  branches and curves beyond dead points are all followed by it.
* ``numerics.homotopy.path_tracking``: all paths of a homotopy at once, each with a step of its own;
  a path leaves the batch when it ends.
* ``kernels.paths.lane_paths``: the same in 64 lanes of compiled code; a lane takes the next path
  when its own has ended.
* ``kernels.march.independent``: 64 mechanisms at once, each with a step of its own; a lane takes
  the next mechanism when it is done.
* ``kernels.march.lockstep``: 64 mechanisms at the same input, so that they share the weights of a
  prediction.
* ``kernels.march.rowwise``: rows of one mechanism side by side; the distance of rows is the step.
* ``kernels.gpu.march``: one thread follows one mechanism.
* ``frontend/src/solving/march.ts``: a page follows its mechanism, as that thread does.
"""
