"""Who can reach a farm: nobody on this machine but its user, and elsewhere those who have its certificates."""

import shutil
import subprocess
import sys
from types import SimpleNamespace

import pytest
from farms import (ENDLESS, FARM, SMALL, assert_is_refused, connect, end, engine, engine_with, farm,  # noqa: F401
                   held, make_assets, processes_of, psutil, start_farm, wait_for)

import isoshell
from isoshell._farm._assets import Asset
from isoshell._farm._clusters import cluster_of
from isoshell._farm._manifest import Writer
from isoshell._farm._plan import Plan
from isoshell._farm._run import over

TLS = {"ca-file": "tls_ca_file", "cert": "tls_client_cert", "key": "tls_client_key"}


def test_a_local_farm_listens_at_no_port(held, tmp_path):
    process = start_farm("run", held, tmp_path / "out", *SMALL, *ENDLESS)
    try:
        wait_for(lambda: processes_of(process, "isoshell._farm._child"))
        own = psutil.Process(process.pid)
        listening = [(each.pid, connection) for each in (own, *own.children(recursive=True))
                     for connection in each.net_connections("all") if connection.status == "LISTEN" or connection.laddr]
        assert listening == []
    finally:
        end(process)


def test_a_local_farm_needs_no_network(tmp_path):
    apart = ["unshare", "--map-root-user", "--net"]
    if not shutil.which("unshare") or subprocess.run([*apart, "true"], capture_output=True).returncode:
        pytest.skip("no network of its own can be made here")
    words = ["run", make_assets(tmp_path / "assets", 1), tmp_path / "out", *SMALL]
    done = subprocess.run([*apart, *FARM, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0 and "arning" not in done.stderr, done.stderr


def test_jobs_of_slurm_and_nobody_else_can_connect(tmp_path):
    pytest.importorskip("dask_jobqueue")
    pytest.importorskip("cryptography")
    import dask
    from distributed.security import Security

    from isoshell._farm._clusters import slurm_cluster

    job = {"jobqueue.slurm.cores": 1, "jobqueue.slurm.memory": "1GB",
           "jobqueue.slurm.shared-temp-directory": str(tmp_path)}
    with dask.config.set(job), slurm_cluster(False) as cluster:
        keys = [path for path in tmp_path.iterdir() if "PRIVATE KEY" in path.read_text()]
        assert len(keys) == 1 and f"--tls-key {keys[0]}" in cluster.job_script()
        assert keys[0].stat().st_mode & 0o077 == 0
        assert cluster.scheduler_address.startswith("tls://")
        assert cluster.scheduler.http_server.address == "127.0.0.1"
        connect(cluster.scheduler_address, security=cluster.security)
        assert_is_refused(cluster.scheduler_address.replace("tls:", "tcp:"))
        assert_is_refused(cluster.scheduler_address, "certificate", security=Security.temporary())


def test_a_scheduler_that_asks_for_no_certificate_is_warned_of(engine, tmp_path):
    done = farm("run", make_assets(tmp_path / "assets", 1), tmp_path / "out", *SMALL[:4], "--scheduler", engine[0])
    assert done.returncode == 0 and "asks for no certificate" in done.stderr, done.stderr


def test_a_scheduler_with_tls_is_connected_to_as_dask_is_configured(tmp_path, monkeypatch):
    pytest.importorskip("cryptography")
    from distributed.security import Security

    made, words = Security.temporary(), ["--protocol", "tls"]
    for name, field in TLS.items():
        path = tmp_path / f"{name}.pem"
        path.write_text(getattr(made, field))
        words += [f"--tls-{name}", path]
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TLS__CA_FILE", str(tmp_path / "ca-file.pem"))
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT", str(tmp_path / "cert.pem"))
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TLS__CLIENT__KEY", str(tmp_path / "key.pem"))
    engine = engine_with(tmp_path, *words)  # noqa: F811
    address = next(engine)[0]
    done = farm("run", make_assets(tmp_path / "assets", 1), tmp_path / "out", *SMALL[:4], "--scheduler", address)
    assert done.returncode == 0 and "certificate" not in done.stderr, done.stderr
    assert next(engine, None) is None


def test_the_pages_are_there_where_they_are_asked_for(tmp_path):
    words = ["run", make_assets(tmp_path / "assets", 1), tmp_path / "out", *SMALL[:4], "--dashboard"]
    done = farm(*words)
    if subprocess.run([sys.executable, "-c", "import bokeh"], capture_output=True).returncode:
        assert done.returncode == 2 and "pip install bokeh" in done.stderr
    else:
        assert done.returncode == 0 and "dashboard: http://127.0.0.1:" in done.stderr
    assert "--dashboard is for" in farm(*words, "--scheduler", "tcp://127.0.0.1:9").stderr


def test_the_pages_count_assets(tmp_path):
    """What they show is what the scheduler counts: held until the end, and told of from the beginning."""
    assets = [(Asset(f"/absent/{i}.obj", {}, output=f"{i}.ply"), None) for i in range(33)]
    writer, counted = Writer(str(tmp_path), 0), []
    with cluster_of("local", None, 2, None, False) as cluster:
        def count(row):
            states = cluster.client.cluster.scheduler.task_prefixes["mesh"].states
            counted.append((states["memory"], sum(states.values())))

        common = {"contexts": None, "asset_memory": None, "time_limit": None, "place": {"threads": "1"},
                  "out": str(tmp_path), "run": "0", "newest": 0.0, "memory": None}
        failed = over(cluster._replace(has_pages=True), Plan(assets, 0, 0), common, writer,
                      SimpleNamespace(count=count, show=lambda: None))
        cluster.client.run(isoshell._farm._worker.stop, "0")
    writer.close()
    assert failed == 33 and counted[-1] == (33, 33) and {total for _, total in counted} == {33}
