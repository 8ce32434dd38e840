"""What belongs to an old mesh goes when the mesh does, and not when Python next looks for cycles."""

import gc
import weakref

from falling import falling_disk

from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation


def test_the_equations_of_one_mesh_alone_are_kept(monkeypatch):
    made = weakref.WeakSet()
    begin = SparseDiscretisation.__init__
    monkeypatch.setattr(SparseDiscretisation, "__init__", lambda self, *given: made.add(self) or begin(self, *given))
    scene = falling_disk(mesh={"size": 0.3, "size_body": 0.05, "remesh_every": 0.008}, time={"step": 0.004, "end": 0.1})
    gc.collect()
    gc.disable()
    try:
        simulation = Simulation(scene, None, False)
        for _ in range(6):
            simulation.step()
        assert simulation.counts.remeshes >= 2
        assert len(made) == 1
    finally:
        gc.enable()
