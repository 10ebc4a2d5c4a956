import undrift


def test_the_package_says_its_version_and_has_one_error() -> None:
    assert undrift.__version__.count(".") == 2
    assert issubclass(undrift.UndriftError, ValueError)
    assert set(undrift.__all__) <= set(dir(undrift))
