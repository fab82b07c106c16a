"""What comparisons with SimpleITK share."""

import pytest
import SimpleITK as sitk


@pytest.fixture
def one_thread():
    """The number of threads moves the last bit of SimpleITK's values."""
    before = sitk.ProcessObject.GetGlobalDefaultNumberOfThreads()
    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(1)
    yield
    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(before)
