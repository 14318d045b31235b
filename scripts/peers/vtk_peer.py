#!/usr/bin/python3
"""What VTK does with the inputs of tet4d-report and of scripts/bench: the peer beside our rows. Runs one filter and prints one JSON line;
errors of its results are measured by the caller, with the code that measures ours.

usage: vtk_peer.py isosurfaces RAW SIZE ISO OUT FRAME...   vtkFlyingEdges3D of every frame of RAW (float32, SIZE^3 samples a frame); the
                                                           surfaces of the frames named go to OUT-FRAME.points.f32 and .triangles.u32, cells
       vtk_peer.py decimate IN RATIO OUT                   vtkUnstructuredGridQuadricDecimation of the hypermesh IN.pts4.f32, IN.tet.i32
                                                           as (x, y, z; scalar t), to OUT.pts4.f32, OUT.tet.i32
       vtk_peer.py slices IN RUNS THREADS TIME...          vtkContour3DLinearGrid of t with a scalar tree, points merged, warm
needs: python3-vtk9; without it the line is {"absent": "why"} and the exit code 0.
"""
import json
import resource
import statistics
import sys
import time

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
except ImportError as error:
    print(json.dumps({"absent": f"VTK for python is not there ({error}); Debian: python3-vtk9"}))
    sys.exit(0)


def seconds(action):
    """Seconds on the clock and of CPU, and what the action returned."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = action()
    return time.perf_counter() - wall, time.process_time() - cpu, result


def isosurfaces(raw, size, iso, out, *wanted):
    size = int(size)
    fields = np.memmap(raw, "<f4", "r").reshape(-1, size ** 3)
    wanted = {int(frame) for frame in wanted}
    wall = cpu = triangles = 0
    vtk.vtkSMPTools.Initialize(1)
    for k, field in enumerate(fields):
        image = vtk.vtkImageData()
        image.SetDimensions(size, size, size)
        image.GetPointData().SetScalars(numpy_to_vtk(np.array(field), deep=0))
        edges = vtk.vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.SetValue(0, float(iso))
        edges.ComputeNormalsOff(), edges.ComputeGradientsOff(), edges.ComputeScalarsOff()
        w, c, _ = seconds(edges.Update)
        wall, cpu, triangles = wall + w, cpu + c, triangles + edges.GetOutput().GetNumberOfPolys()
        if k in wanted:
            surface = edges.GetOutput()
            vtk_to_numpy(surface.GetPoints().GetData()).astype("<f4").tofile(f"{out}-{k}.points.f32")
            vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).astype("<u4").tofile(f"{out}-{k}.triangles.u32")
    return {"seconds_wall": wall, "seconds_cpu": cpu, "triangles": triangles, "frames": len(fields)}


def hypermesh(base):
    points = np.fromfile(base + ".pts4.f32", "<f4").reshape(-1, 4)
    tets = np.fromfile(base + ".tet.i32", "<i4").reshape(-1, 4)
    grid, places, cells = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkCellArray()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points[:, :3]), deep=1))
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, tets.size + 1, 4, dtype=np.int64), deep=1),
                  numpy_to_vtkIdTypeArray(tets.ravel().astype(np.int64), deep=1))
    grid.SetPoints(places)
    grid.SetCells(vtk.VTK_TETRA, cells)
    t = numpy_to_vtk(np.ascontiguousarray(points[:, 3]), deep=1)
    t.SetName("t")
    grid.GetPointData().SetScalars(t)
    return grid, len(tets)


def decimate(base, ratio, out):
    grid, tets = hypermesh(base)
    filtered = vtk.vtkUnstructuredGridQuadricDecimation()
    filtered.SetInputData(grid)
    filtered.SetScalarsName("t")
    filtered.SetTargetReduction(1 - float(ratio))
    wall, cpu, _ = seconds(filtered.Update)
    result = filtered.GetOutput()
    left = result.GetNumberOfCells()
    if left > 0:
        points = np.empty((result.GetNumberOfPoints(), 4), "<f4")
        points[:, :3] = vtk_to_numpy(result.GetPoints().GetData())
        points[:, 3] = vtk_to_numpy(result.GetPointData().GetArray(0))
        points.tofile(out + ".pts4.f32")
        vtk_to_numpy(result.GetCells().GetConnectivityArray()).astype("<i4").tofile(out + ".tet.i32")
    return {"seconds_wall": wall, "seconds_cpu": cpu, "tets_in": tets, "tets": left}


def slices(base, runs, threads, *times):
    vtk.vtkSMPTools.Initialize(int(threads))
    grid, tets = hypermesh(base)
    contour = vtk.vtkContour3DLinearGrid()
    contour.SetInputData(grid)
    contour.MergePointsOn(), contour.ComputeNormalsOff(), contour.InterpolateAttributesOff(), contour.UseScalarTreeOn()
    each, triangles = [], 0
    for run in range(int(runs) + 1):  # the first builds the tree
        spent, triangles = [], 0
        for at in times:
            contour.SetValue(0, float(at))
            spent.append(seconds(contour.Update)[0])
            triangles += contour.GetOutput().GetNumberOfPolys()
        if run > 0:
            each.append(statistics.median(spent))
    return {"tets": tets, "slices": len(times), "slice_ms": 1e3 * statistics.median(each), "triangles": triangles / len(times)}


def main():
    actions = {"isosurfaces": isosurfaces, "decimate": decimate, "slices": slices}
    if len(sys.argv) < 2 or sys.argv[1] not in actions:
        sys.exit(__doc__)
    line = actions[sys.argv[1]](*sys.argv[2:])
    line["peak_bytes"] = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    line["version"] = vtk.vtkVersion().GetVTKVersion()
    print(json.dumps(line))


if __name__ == "__main__":
    main()
