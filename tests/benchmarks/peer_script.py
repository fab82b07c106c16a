"""The least a SimpleITK user writes for the paper's job: 300 evaluations, the aligned image, the transform.

Run as ``python peer_script.py VISUAL THERMAL OUT``; `test_command.py` times it beside ``regframe register``.
"""

import sys

import SimpleITK as sitk

visual, thermal, out = sys.argv[1:]
fixed, moving = (sitk.ReadImage(path, sitk.sitkFloat32) for path in (visual, thermal))
fixed.SetSpacing((1.0, 1.0))
moving.SetSpacing((1.0, 1.0))
run = sitk.ImageRegistrationMethod()
run.SetMetricAsMattesMutualInformation(50)
run.SetOptimizerAsOnePlusOneEvolutionary(299, 1.5e-4, 6.25e-3, 1.05, seed=1)
run.SetOptimizerScales([1, 1, 1e-3, 1e-3])
run.SetInterpolator(sitk.sitkBSpline)
start = sitk.CenteredTransformInitializer(
    fixed, moving, sitk.Similarity2DTransform(), sitk.CenteredTransformInitializerFilter.GEOMETRY
)
start = sitk.Similarity2DTransform(start)
start.SetScale(moving.GetWidth() / fixed.GetWidth())
run.SetInitialTransform(start)
found = run.Execute(fixed, moving)
aligned = sitk.Resample(sitk.ReadImage(thermal), fixed, found, sitk.sitkLinear)
sitk.WriteImage(aligned, f"{out}/aligned.png")
sitk.WriteTransform(found, f"{out}/transform.tfm")
