!> Impulses at unilateral contacts with Coulomb friction: the velocities of rigid bodies after a time step or a blow.
!>
!> With masses M, velocities f that the bodies would have without contacts, and for each contact point the parting
!> velocity w_n = n.v + b_n and the sliding velocity w_t = t.v + b_t (Moreau 1988, Jean 1999):
!>
!>    M (v - f) = sum of n p_n + t p_t,    0 <= p_n  _|_  w_n >= 0,    |p_t| <= mu p_n, p_t opposes w_t.
!>
!> With the parting velocities raised by c = mu |w_t| this says that impulses lie in the friction cone and velocities in
!> its dual, at right angles (de Saxce and Feng 1998). For c held it is a convex problem, and c follows from round to
!> round (Acary, Cadoux, Lemarechal and Malick 2011). The convex problem is solved by augmented Lagrangians (Alart and
!> Curnier 1991): with weights r the impulses are those which the projection on the cone
!>
!>    p = P(p - r (w_n + c, w_t))
!>
!> leaves unchanged. For p held on the right, the velocities are those of least energy: the unique minimum of a convex,
!> piecewise quadratic function, which Newton's method finds in a few steps, with one sparse factorisation for each set
!> of points that stick, slide and part. Then p and c follow together; few rounds are needed, since the weights are
!> large. Where more impulses than velocities are unknown (two points of a joint, arches), those nearest to the ones at
!> the start are found.
!>
!> Points that never slide (`no_sliding`) have c = 0 and the half plane p_n >= 0 for a cone: the problem is convex as it
!> is, and the velocities are those nearest to f, in kinetic energy, at which nothing overlaps or slides.
module nonsmooth_impulses
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use nonsmooth_skyline, only : skyline, skyline_add, skyline_factor, skyline_new, skyline_solve, freedoms
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: impulse_problem, impulse_effort, problem_new, problem_room, solve_impulses

   integer, parameter, public :: along_normal = 1, along_tangent = 2
   !> Friction of points that never slide, nor where they part: the cone is a half plane (its square does not overflow)
   real(wp), parameter, public :: no_sliding = 1.0e100_wp
   real(wp), parameter :: growth = 10.0_wp       !! of the weights where impulses have far to go
   integer, parameter :: patience = 15           !! rounds before that
   integer, parameter :: most_growth = 2         !! times
   integer, parameter :: most_newton = 60
   integer, parameter :: most_halvings = 30
   integer, parameter :: parts = 0, sticks = 1, slides_up = 2, slides_down = 3

   type :: impulse_problem
      integer :: nodes = 0                          !! bodies that move
      integer :: points = 0
      real(wp) :: heavy = 1.0e2_wp                  !! weights over the mass that a point feels
      real(wp), allocatable :: mass(:)              !! (3 nodes) by rank: mass, mass, inertia
      real(wp), allocatable :: free(:)              !! (3 nodes) velocities without contacts
      real(wp), allocatable :: rate(:)              !! (3 nodes) velocities: a guess in, the answer out
      integer, allocatable :: node(:, :)            !! (2, points) ranks of both bodies, 0 where one is prescribed
      real(wp), allocatable :: row(:, :, :, :)      !! (3, side, direction, points): w = sum of row.v + shift
      real(wp), allocatable :: shift(:, :)          !! (direction, points) [m/s]
      real(wp), allocatable :: friction(:)          !! (points) coefficient
      real(wp), allocatable :: impulse(:, :)        !! (direction, points): a guess in, the answer out [N s]
      type(skyline) :: matrix
      real(wp), allocatable :: weight(:)            !! (points) r
      real(wp), allocatable :: raised(:)            !! (points) c [m/s]
      real(wp), allocatable :: rate_at(:, :)        !! (direction, points) w [m/s]
      real(wp), allocatable :: trial(:, :)          !! (direction, points) p - r (w_n + c, w_t)
      real(wp), allocatable :: try(:), load(:)      !! (3 nodes)
      integer, allocatable :: state(:), was(:)      !! (points) what they do, and did when the matrix was factored
   end type impulse_problem

   !> What a solution took
   type :: impulse_effort
      integer :: rounds = 0                         !! new impulses
      integer :: factors = 0                        !! sparse factorisations
      real(wp) :: residual = 0.0_wp                 !! greatest violation of the law, as a velocity [m/s]
      logical :: converged = .false.
   end type impulse_effort

contains

   !> A problem of `nodes` bodies, `links` pairs of which may touch
   subroutine problem_new(nodes, link, problem, status)
      integer, intent(in) :: nodes
      integer, intent(in) :: link(:, :)             !! (2, links)
      type(impulse_problem), intent(out) :: problem
      integer(c_int), intent(out) :: status
      integer :: failed
      problem%nodes = nodes
      call skyline_new(nodes, link, problem%matrix, status)
      if (status /= status_ok) return
      allocate (problem%mass(freedoms * nodes), problem%free(freedoms * nodes), problem%rate(freedoms * nodes), &
         problem%try(freedoms * nodes), problem%load(freedoms * nodes), stat=failed)
      if (failed /= 0) status = status_out_of_memory
   end subroutine problem_new

   !> Room for `points` contact points
   subroutine problem_room(problem, points, status)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: points
      integer(c_int), intent(out) :: status
      integer :: failed
      allocate (problem%node(2, points), problem%row(freedoms, 2, 2, points), problem%shift(2, points), &
         problem%friction(points), problem%impulse(2, points), problem%weight(points), problem%raised(points), &
         problem%rate_at(2, points), problem%trial(2, points), problem%state(points), problem%was(points), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
   end subroutine problem_room

   !> Impulses and velocities
   pure subroutine solve_impulses(problem, tolerance, most_rounds, effort)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! violation that is let pass [m/s]
      integer, intent(in) :: most_rounds
      type(impulse_effort), intent(out) :: effort
      integer :: n

      n = problem%points
      call weigh(problem)
      problem%was(:n) = -1
      problem%raised(:n) = 0.0_wp
      call look(problem, problem%rate)
      problem%raised(:n) = raising(problem%friction(:n), problem%rate_at(along_tangent, :n))
      do while (effort%rounds < most_rounds)
         effort%rounds = effort%rounds + 1
         call least_energy(problem, tolerance, effort)
         call take_impulses(problem, effort%residual)
         effort%converged = effort%residual <= tolerance
         if (effort%converged) exit
         if (mod(effort%rounds, patience) > 0 .or. effort%rounds > patience * most_growth) cycle
         problem%weight(:n) = growth * problem%weight(:n)
         problem%was(:n) = -1
      end do
      call velocities(problem)
   end subroutine solve_impulses

   !> Weights: many times the mass that a point feels
   pure subroutine weigh(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k, d, side, at
      real(wp) :: lightness(2)
      do k = 1, problem%points
         lightness = 0.0_wp
         do d = 1, 2
            do side = 1, 2
               if (problem%node(side, k) == 0) cycle
               at = freedoms * (problem%node(side, k) - 1)
               lightness(d) = lightness(d) + sum(problem%row(:, side, d, k)**2 / problem%mass(at + 1:at + freedoms))
            end do
         end do
         problem%weight(k) = problem%heavy / maxval(lightness)
      end do
   end subroutine weigh

   !> Velocities at the points, trial impulses, and what the points do, at some velocities of the bodies
   pure subroutine look(problem, rate)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: rate(:)
      integer :: k, d, side, at
      real(wp) :: w
      do k = 1, problem%points
         do d = 1, 2
            w = problem%shift(d, k)
            do side = 1, 2
               if (problem%node(side, k) == 0) cycle
               at = freedoms * (problem%node(side, k) - 1)
               w = w + dot_product(problem%row(:, side, d, k), rate(at + 1:at + freedoms))
            end do
            problem%rate_at(d, k) = w
         end do
         problem%trial(:, k) = problem%impulse(:, k) &
            - problem%weight(k) * (problem%rate_at(:, k) + [problem%raised(k), 0.0_wp])
         problem%state(k) = state_of(problem%friction(k), problem%trial(:, k))
      end do
   end subroutine look

   !> Where a trial impulse lies: in the friction cone, in its polar cone, or beside
   pure function state_of(friction, trial) result(state)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: trial(2)
      integer :: state
      if (abs(trial(2)) <= friction * trial(1)) then
         state = sticks
      else if (friction * abs(trial(2)) <= -trial(1)) then
         state = parts
      else
         state = merge(slides_up, slides_down, trial(2) > 0.0_wp)
      end if
   end function state_of

   !> c: by how much the parting velocity is raised where a point slides
   elemental function raising(friction, sliding) result(c)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: sliding               !! [m/s]
      real(wp) :: c
      c = 0.0_wp
      if (friction < no_sliding) c = friction * abs(sliding)
   end function raising

   !> Edge of the friction cone on which a point slides: unit vector of its impulse
   pure function edge(friction, state) result(direction)
      real(wp), intent(in) :: friction
      integer, intent(in) :: state
      real(wp) :: direction(2)
      direction = [1.0_wp, merge(friction, -friction, state == slides_up)] / sqrt(1.0_wp + friction**2)
   end function edge

   !> The point of the friction cone nearest to a trial impulse
   pure function projected(friction, state, trial) result(impulse)
      real(wp), intent(in) :: friction
      integer, intent(in) :: state
      real(wp), intent(in) :: trial(2)
      real(wp) :: impulse(2)
      select case (state)
      case (sticks)
         impulse = trial
      case (parts)
         impulse = 0.0_wp
      case default
         impulse = edge(friction, state) * dot_product(edge(friction, state), trial)
      end select
   end function projected

   !> The function that is least at the velocities sought, at velocities that have been looked at
   pure function energy(problem, rate) result(total)
      type(impulse_problem), intent(in) :: problem
      real(wp), intent(in) :: rate(:)
      real(wp) :: total
      integer :: k
      total = sum(problem%mass * (rate - problem%free)**2)
      do k = 1, problem%points
         total = total &
            + sum(projected(problem%friction(k), problem%state(k), problem%trial(:, k))**2) / problem%weight(k)
      end do
      total = 0.5_wp * total
   end function energy

   !> Newton's method for the velocities at which that function is least
   pure subroutine least_energy(problem, tolerance, effort)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! [m/s]
      type(impulse_effort), intent(inout) :: effort
      integer :: n, round, halving
      real(wp) :: now, next
      logical :: whole, still
      integer(c_int) :: status

      n = problem%points
      call look(problem, problem%rate)
      now = energy(problem, problem%rate)
      do round = 1, most_newton
         if (any(problem%state(:n) /= problem%was(:n))) then
            call assemble(problem)
            call skyline_factor(problem%matrix, status)
            problem%was(:n) = problem%state(:n)
            effort%factors = effort%factors + 1
            if (status /= status_ok) return          ! not finite: the caller sees velocities that are not
         end if
         call right_side(problem)
         problem%try(:) = problem%load
         call skyline_solve(problem%matrix, problem%try)
         do halving = 0, most_halvings
            call look(problem, problem%try)
            next = energy(problem, problem%try)
            if (.not. next > now + 1.0e-12_wp * abs(now)) exit
            problem%try(:) = 0.5_wp * (problem%try + problem%rate)
         end do
         whole = halving == 0
         ! Points on the verge of sliding may change sides for ever and move nothing.
         still = whole .and. maxval(abs(problem%try - problem%rate)) < 0.01_wp * tolerance
         problem%rate(:) = problem%try
         now = next
         if (still .or. (whole .and. all(problem%state(:n) == problem%was(:n)))) return
      end do
   end subroutine least_energy

   !> M + sum of r row row' over the directions in which points resist
   pure subroutine assemble(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: i, k, d
      real(wp) :: along(2), row(freedoms, 2)
      problem%matrix%a(:) = 0.0_wp
      do i = 1, problem%matrix%n
         problem%matrix%a(problem%matrix%start(i) + i) = problem%mass(i)
      end do
      do k = 1, problem%points
         select case (problem%state(k))
         case (sticks)
            do d = 1, 2
               call add_row(problem, k, problem%row(:, :, d, k))
            end do
         case (slides_up, slides_down)
            along = edge(problem%friction(k), problem%state(k))
            row = along(1) * problem%row(:, :, 1, k) + along(2) * problem%row(:, :, 2, k)
            call add_row(problem, k, row)
         case default
            cycle
         end select
      end do
   end subroutine assemble

   pure subroutine add_row(problem, k, row)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: k                      !! point
      real(wp), intent(in) :: row(freedoms, 2)      !! of both bodies
      associate (node => problem%node(:, k), weight => problem%weight(k))
         if (node(1) > 0) call skyline_add(problem%matrix, node(1), node(1), weight, row(:, 1), row(:, 1))
         if (node(2) > 0) call skyline_add(problem%matrix, node(2), node(2), weight, row(:, 2), row(:, 2))
         if (all(node > 0)) call skyline_add(problem%matrix, node(1), node(2), weight, row(:, 1), row(:, 2))
      end associate
   end subroutine add_row

   !> M f + what the points give at rest
   pure subroutine right_side(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k
      real(wp) :: rest(2)
      problem%load(:) = problem%mass * problem%free
      do k = 1, problem%points
         if (problem%state(k) == parts) cycle
         rest = problem%impulse(:, k) - problem%weight(k) * (problem%shift(:, k) + [problem%raised(k), 0.0_wp])
         call add_impulse(problem, k, projected(problem%friction(k), problem%state(k), rest), problem%load)
      end do
   end subroutine right_side

   !> Add an impulse at a point to the momentum of both bodies
   pure subroutine add_impulse(problem, k, impulse, momentum)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp), intent(in) :: impulse(2)            !! [N s]
      real(wp), intent(inout) :: momentum(:)
      integer :: side, at
      do side = 1, 2
         if (problem%node(side, k) == 0) cycle
         at = freedoms * (problem%node(side, k) - 1)
         momentum(at + 1:at + freedoms) = momentum(at + 1:at + freedoms) &
            + impulse(1) * problem%row(:, side, 1, k) + impulse(2) * problem%row(:, side, 2, k)
      end do
   end subroutine add_impulse

   !> New impulses from the trial ones, and by how much the law was violated
   pure subroutine take_impulses(problem, residual)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(out) :: residual             !! [m/s]
      real(wp) :: impulse(2), raised
      integer :: k
      residual = 0.0_wp
      do k = 1, problem%points
         impulse = projected(problem%friction(k), problem%state(k), problem%trial(:, k))
         raised = raising(problem%friction(k), problem%rate_at(along_tangent, k))
         residual = max(residual, maxval(abs(impulse - problem%impulse(:, k))) / problem%weight(k))
         if (problem%state(k) > sticks) residual = max(residual, abs(raised - problem%raised(k)))
         problem%impulse(:, k) = impulse
         problem%raised(k) = raised
      end do
   end subroutine take_impulses

   !> Velocities that follow from the impulses
   pure subroutine velocities(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k
      problem%rate(:) = problem%mass * problem%free
      do k = 1, problem%points
         call add_impulse(problem, k, problem%impulse(:, k), problem%rate)
      end do
      problem%rate(:) = problem%rate / problem%mass
   end subroutine velocities

end module nonsmooth_impulses
