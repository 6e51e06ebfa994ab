"""Mass properties of solids of uniform density, from their triangles."""

from collections.abc import Sequence

import numpy as np

from scenes.inertia import MassProperties, principal_axes
from scenes.solids import Solid


def uniform_mass(bodies: Sequence[Solid], density_kg_m3: float) -> MassProperties:
    """Moments (ascending), centre of mass and principal axes of closed solids; where two overlap, both count.

    Volume integrals over tetrahedra by trimesh, put together about the common centre by the parallel-axis theorem.
    """
    from trimesh import Trimesh

    meshes = [Trimesh(body.vertices_target, body.faces, process=False) for body in bodies]
    masses = density_kg_m3 * np.array([mesh.volume for mesh in meshes])
    centres = np.array([mesh.center_mass for mesh in meshes])
    centre = masses @ centres / masses.sum()
    inertia = np.zeros((3, 3))
    for mesh, mass, apart in zip(meshes, masses, centres - centre):
        inertia += density_kg_m3 * mesh.moment_inertia + mass * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    moments, axes = principal_axes(inertia)
    w, x, y, z = axes.as_quat(canonical=True, scalar_first=True).tolist()
    (ix, iy, iz), (cx, cy, cz) = moments.tolist(), centre.tolist()
    return MassProperties(principal_kg_m2=(ix, iy, iz), centre_of_mass_m=(cx, cy, cz), quaternion_wxyz=(w, x, y, z))
