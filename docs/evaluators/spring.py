import math, os, sys, uuid
import grpc
from mortise.v1 import evaluator_pb2, evaluator_pb2_grpc, simulator_pb2, simulator_pb2_grpc

NAME = "evaluators/spring"
SPACE = evaluator_pb2.DesignSpace(
    parameters=[dict(name="wire", unit="m", minimum=1e-3, maximum=5e-3, default_value=3e-3),
                dict(name="diameter", unit="m", minimum=0.02, maximum=0.06, default_value=0.03),
                dict(name="turns", unit="1", minimum=3, maximum=10, default_value=8, step=1),
                dict(name="material", unit="1", maximum=1, step=1, choices=["steel", "titanium"])],
    metrics=[dict(name="mass", unit="kg"), dict(name="stiffness", unit="N/m")])

def evaluate(wire, diameter, turns, material):  # a helical spring; your solver goes here
    density, modulus = [(7850, 80e9), (4430, 44e9)][int(material)]
    volume = math.pi * wire**2 / 4 * math.pi * diameter * turns
    return {"mass": density * volume, "stiffness": modulus * wire**4 / (8 * diameter**3 * turns)}

def result_of(task):
    try:
        values = evaluate(*task.point.parameters)
        if not all(map(math.isfinite, values.values())): raise ValueError(values)
        return dict(metrics=[dict(name=name, value=values[name]) for name in task.metrics])
    except Exception as fault:  # this design cannot be evaluated; 3 is INVALID_ARGUMENT
        return dict(error=dict(code=3, message=f"{type(fault).__name__}: {fault}"))

channel = grpc.insecure_channel(sys.argv[1])
tasks = simulator_pb2_grpc.SimulatorServiceStub(channel)
evaluator_pb2_grpc.EvaluatorServiceStub(channel).CreateEvaluator(
    evaluator_pb2.CreateEvaluatorRequest(request_id=str(uuid.uuid4()), evaluator=dict(
        name=NAME, title="Helical spring", version="1", space=SPACE)), wait_for_ready=True)
while True:
    leased = tasks.LeaseTasks(simulator_pb2.LeaseTasksRequest(
        evaluator=NAME, worker=f"spring-{os.getpid()}", limit=4, lease_seconds=10,
        wait_seconds=20), wait_for_ready=True)
    for task in leased.tasks:
        try:
            tasks.ReportTask(simulator_pb2.ReportTaskRequest(
                task=dict(name=task.name, attempt=task.attempt), result=result_of(task)))
        except grpc.RpcError as refusal:  # such as that the task is another worker's by now
            print(task.name, refusal.details(), file=sys.stderr)
