"""A made-up carry in the shape of the contract, for development before the world exists."""
import hashlib
from dataclasses import dataclass, replace
import numpy as np, xarray as xr

@dataclass(frozen=True)
class Correction:
    label: str; robot: str; case: str; assistant: str|None; start_s: float; end_s: float
@dataclass(frozen=True)
class Letter:
    sent_s: float; received_s: float|None; sender: str; receiver: str; letter: str
@dataclass(frozen=True)
class Carry:
    scene: object; controller: str; world: str; precision: str; seed: int; version: str; outcome: str; reason: str|None
    time_s: float; distance_m: float; contact_rms_m: dict; contact_peak_m: dict; corrections: tuple; messages: int
    waiting_s: dict; warnings: tuple; trace_hash: str; trace: object; letters: tuple

def scene(offset=0.0,distance=1.5):
    from palmbots.scene import load_scene
    return load_scene({},{"palm.pivot_offset_m":offset,"task.distance_m":distance})

def label(i):
    return (chr(65+i//26-1) if i>=26 else "")+chr(65+i%26)

STORY=[("right","a",.55,1.0),("right","d",1.4,1.75),("right","d",2.1,2.5),("right","d",2.95,3.65),("left","d",3.3,3.9),("right","a",4.4,5.2),("left","d",5.3,5.85)]

def story(seconds=6.5, repeat=1, seed=0, outcome="delivered", reason=None, controller="distributed", offset=0.0):
    rng=np.random.default_rng(seed); dt=.01; n=int(round(seconds/dt))+1; t=np.arange(n)*dt
    events=[(r,c,a+6.0*k,b+6.0*k) for k in range(repeat) for r,c,a,b in STORY if b+6*k<seconds] if controller!="none" else []
    p=np.zeros((n,2)); th=np.full((n,2),15.); sg=np.zeros((n,2),np.int8); case=np.full((n,2)," "); mo=np.zeros((n,2),np.int8)
    cmd=np.full((n,2),.06); letters=[]; corr=[]
    walk=np.cumsum(rng.normal(0,.00025,(n,2)),0); walk-=np.linspace(0,1,n)[:,None]*walk[-1]
    p+=np.clip(walk,-.0045,.0045) if events else walk*6+np.linspace(0,.075,n)[:,None]**1*[1,-.2]
    for i,(r,c,a,b) in enumerate(events):
        k=("left","right").index(r); o=1-k; sgn=1 if c=="a" else -1
        m=(t>=a)&(t<b); ramp=(t>=a-.2)&(t<a)
        p[m,k]=sgn*.011*(1-(t[m]-a)/(b-a)); p[ramp,k]+=sgn*.011*(t[ramp]-a+.2)/.2
        case[m,k]=c; sg[m,k]=sgn; mo[m,k]=-sgn
        w=(lambda x,up,dn:np.interp(x,[up,up+.2,dn,dn+.2],[15,5,5,15]))
        who=o if c=="a" else k
        th[:,who]=np.minimum(th[:,who],w(t,a+(.05 if c=="a" else 0),b))
        if c=="a":
            case[(t>=a+.05)&(t<b+.05),o]="c"
            other=("left","right")[o]
            letters+=[Letter(a,a+.05,r,other,"TiltUp"),Letter(a+.25,a+.3,other,r,"Ack"),Letter(b,b+.05,r,other,"TiltDown")]
            m=(t>=a+.3)&(t<b); cmd[m,k]+=.03*(1 if k==1 else -1)
        else:
            m=(t>=a+.2)&(t<b); cmd[m,k]+=.03*(-1 if k==1 else 1)
        corr.append(Correction(label(i),r,c,("left","right")[o] if c=="a" else None,a,b))
    th=np.radians(th); sp=cmd+rng.normal(0,.004,(n,2))
    u=np.stack([np.array([-1,1])*np.cos(th),np.sin(th)],-1); nn=np.stack([np.array([1,-1])*np.sin(th),np.cos(th)],-1)
    q=p[...,None]*u+offset*nn; z=q[:,1,1]-q[:,0,1]; w=.25
    sep=np.sqrt(w*w-z*z)-(q[:,1,0]-q[:,0,0]); mid=np.concatenate([[0],np.cumsum(sp.mean(1)*dt)[:-1]])
    S="time","side"
    ds=xr.Dataset(dict(contact=(S,p,dict(units="m")),palm=(S,th,dict(units="rad")),speed=(S,sp,dict(units="m/s")),commanded=(S,cmd,dict(units="m/s")),
      separation=("time",sep,dict(units="m")),midpoint=("time",mid,dict(units="m")),object=("time",np.arcsin(z/w),dict(units="rad")),sign=(S,sg),case=(S,case),motion=(S,mo)),
      coords=dict(time=("time",t,dict(units="s")),side=["left","right"]))
    letters.sort(key=lambda l:l.sent_s)
    rms=dict(zip(("left","right"),np.sqrt((p**2).mean(0)).tolist())); pk=dict(zip(("left","right"),abs(p).max(0).tolist()))
    h=hashlib.blake2b(p.tobytes(),digest_size=8).hexdigest()
    return Carry(scene(offset),controller,"quasistatic","double",seed,"0.1.0",outcome,reason,float(t[-1]),float(mid[-1]),rms,pk,tuple(corr),len(letters),dict(left=0.,right=.9),(),h,ds,tuple(letters))
