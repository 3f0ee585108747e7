"""Least effort of a motor that swings up one or two rods, by CasADi: the discrete equations of docs/theory.md written again.

Prints the objective in (N m)^2 s of each case of `motor.json`. Needs the package casadi.
"""
import casadi as ca

# Bodies: cylinders of mass m, length L, radius r, hanging from hinges about z; y up.
def solve(n_links, N, T, bound, goal):
    m, L, r, g = 0.2, 0.3, 0.005, 9.81
    h = T / N
    # Euler tensor of a cylinder about its axis d (along), and across: moments J_perp = m(3r²+L²)/12, J_axis = m r²/2
    Jp = m*(3*r*r+L*L)/12; Ja = m*r*r/2
    E_along = Jp - Ja/2; E_across = Ja/2      # E = ½(tr J) I − J
    def vectors(q):
        out = []; x = ca.DM.zeros(2); a = 0
        joint = ca.vertcat(0, 0)
        for i in range(n_links):
            a = a + q[i]
            d1 = ca.vertcat(ca.cos(a), ca.sin(a))     # across in the plane
            d2 = ca.vertcat(-ca.sin(a), ca.cos(a))    # along, from tip to hinge
            centre = joint - L/2*d2
            out.append((centre, d1, d2))
            joint = joint - L*d2
        return out
    def Ld(q0, q1, u):
        A, B = vectors(q0), vectors(q1)
        total = 0
        for (c0, a0, b0), (c1, a1, b1) in zip(A, B):
            total += 0.5*m*ca.sumsqr((c1-c0)/h) + 0.5*E_across*ca.sumsqr((a1-a0)/h) + 0.5*E_along*ca.sumsqr((b1-b0)/h)
            total -= m*g*(c0[1]+c1[1])/2
        total += u*(q0[0]+q1[0])/2
        return h*total
    a, b, u = ca.SX.sym('a', n_links), ca.SX.sym('b', n_links), ca.SX.sym('u')
    L_ = Ld(a, b, u)
    D1 = ca.Function('D1', [a, b, u], [ca.gradient(L_, a)])
    D2 = ca.Function('D2', [a, b, u], [ca.gradient(L_, b)])
    q = [ca.SX.sym(f'q{k}', n_links) for k in range(1, N)]
    us = ca.SX.sym('u', N)
    all_q = [ca.DM.zeros(n_links)] + q + [ca.DM(goal)]
    con = [D1(all_q[0], all_q[1], us[0])]
    for k in range(1, N):
        con.append(D2(all_q[k-1], all_q[k], us[k-1]) + D1(all_q[k], all_q[k+1], us[k]))
    con.append(D2(all_q[N-1], all_q[N], us[N-1]))
    J = h*ca.sumsqr(us)
    x = ca.vertcat(*q, us)
    s = [k/N for k in range(1, N)]
    guess = [ca.DM(goal)*(3*t*t-2*t**3) for t in s]
    x0 = ca.vertcat(*guess, ca.DM.zeros(N))
    nlp = {'x': x, 'f': J, 'g': ca.vertcat(*con)}
    S = ca.nlpsol('S', 'ipopt', nlp, {'ipopt.print_level': 0, 'print_time': 0, 'ipopt.tol': 1e-12, 'ipopt.max_iter': 3000, 'ipopt.bound_relax_factor': 0.0})
    nq = n_links*(N-1)
    lb = [-ca.inf]*nq + [-bound]*N; ub = [ca.inf]*nq + [bound]*N
    res = S(x0=x0, lbx=lb, ubx=ub, lbg=0, ubg=0)
    print(n_links, S.stats()['return_status'], '%.14e' % float(res['f']))
solve(1, 60, 1.2, 0.15, [ca.pi])
solve(2, 60, 1.2, 0.8, [ca.pi, 0])
