"""QEMU's own protocol: what tells an emulator to stop, to save and to quit."""

import json


class QmpError(Exception):
    """QEMU refused; the message has its words."""


class Monitor:
    """`channel`: a connected stream socket, which it owns. Every wait is bounded by the channel's time-out; OSError when that passes."""

    def __init__(self, channel):
        self.channel = channel
        self.lines = channel.makefile("rb")
        self.events = []
        self.read()  # the greeting
        self.execute("qmp_capabilities")

    def close(self):
        self.lines.close()
        self.channel.close()

    def read(self):
        line = self.lines.readline()
        if not line:
            raise QmpError("QEMU has ended")
        return json.loads(line)

    def execute(self, command, **arguments):
        """What it answers; a dash in a name is written as underscore. Events that come before are kept for run_job()."""
        words = {name.replace("_", "-"): value for name, value in arguments.items()}
        self.channel.sendall(json.dumps({"execute": command, "arguments": words}).encode() + b"\n")
        while True:
            message = self.read()
            if "event" in message:
                self.events.append(message)
            elif "error" in message:
                raise QmpError(f"{command}: {message['error']['desc']}")
            else:
                return message["return"]

    def run_job(self, command, **arguments):
        """Until it is done."""
        self.execute(command, job_id="job", **arguments)
        while True:
            event = self.events.pop(0) if self.events else self.read()
            if event.get("event") == "JOB_STATUS_CHANGE" and event["data"]["status"] == "concluded":
                break
        job, = self.execute("query-jobs")
        self.execute("job-dismiss", id="job")
        if "error" in job:
            raise QmpError(f"{command}: {job['error']}")

    def copy_layer(self, device, path):
        """What DEVICE's topmost layer has, as a qcow2 file on top of the same file, which is not touched. Not by drive-backup: where the
        layer is that of snapshot=on, QEMU 7.2 removes the file below."""
        below, = (block["inserted"]["image"]["backing-image"] for block in self.execute("query-block") if block["device"] == device)
        self.run_job("blockdev-create", options={"driver": "file", "filename": str(path), "size": 0})
        self.execute("blockdev-add", node_name="copy-file", driver="file", filename=str(path))
        self.run_job("blockdev-create", options={"driver": "qcow2", "file": "copy-file", "size": below["virtual-size"],
                                                 "backing-file": below["filename"], "backing-fmt": below["format"]})
        self.execute("blockdev-add", node_name="copy", driver="qcow2", file="copy-file", backing=None)
        self.run_job("blockdev-backup", device=device, target="copy", sync="top", auto_dismiss=False)
        self.execute("blockdev-del", node_name="copy")
        self.execute("blockdev-del", node_name="copy-file")
