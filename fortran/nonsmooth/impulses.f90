!> Impulses at unilateral contacts with Coulomb friction: the velocities of rigid bodies after a time step or an impact, in
!> the plane (three freedoms of a body, one direction of sliding) or in space (six, two).
!>
!> With masses M, velocities f that the bodies would have without contacts, and for each contact point the parting
!> velocity w_n = n.v + b_n and the sliding velocity w_t = t.v + b_t (Moreau 1988, Jean 1999):
!>
!>    M (v - f) = sum of n p_n + t p_t,    0 <= p_n  _|_  w_n >= 0,    |p_t| <= mu p_n, p_t opposes w_t.
!>
!> With the parting velocities raised by c = mu |w_t| this says that impulses lie in the friction cone and velocities in
!> its dual, at right angles (de Saxce and Feng 1998). For c held it is a convex problem, and c follows from round to
!> round (Acary, Cadoux, Lemarechal and Malick 2011); where it creeps or swings in space, it is taken to where
!> the last two rounds point (Anderson 1965). The convex problem is solved by augmented Lagrangians (Alart and
!> Curnier 1991): with weights r the impulses are those which the projection on the cone
!>
!>    p = P(p - r (w_n + c, w_t))
!>
!> leaves unchanged. For p held on the right, the velocities are those of least energy: the unique minimum of a convex
!> function, sum of squares of projections, which Newton's method finds in a few steps, with one sparse factorisation
!> for each set of points that stick, slide and part, and in space for each turn of what slides, where the cone is
!> round. Then p and c follow together; few rounds are needed, since the weights are large. Where more impulses than
!> velocities are unknown (two points of a joint, arches), those nearest to the ones at the start are found.
!>
!> A point may have strength of its own: |p_t| <= C + mu p_n and p_n >= -T, with T at most C / mu. At the limit of T the
!> point opens, with w_t = 0 or |p_t| = C - mu T, and at the other limit the point slides; the law of motion is the same. Without
!> friction and T, and with a row of zeros along the normal, a point is a dowel of strength C.
!>
!> Points that never slide (`no_sliding`) have c = 0 and the half space p_n >= 0 for a cone: the problem is convex as it
!> is, and the velocities are those nearest to f, in kinetic energy, at which nothing overlaps or slides.
module nonsmooth_impulses
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use nonsmooth_skyline, only : skyline, skyline_add, skyline_factor, skyline_new, skyline_solve
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: impulse_problem, impulse_effort, problem_new, problem_room, solve_impulses, find_point_rate

   !> Directions at a contact point: the normal, then those of sliding
   integer, parameter, public :: along_normal = 1, along_tangent = 2
   integer, parameter, public :: in_plane = 2, in_space = 3
   !> Friction of points that never slide, nor where they part: the cone is a half space (its square does not overflow)
   real(wp), parameter, public :: no_sliding = 1.0e100_wp
   !> Weights over masses at the start, in the plane and in space, where the round cones require Newton's method anyway
   real(wp), parameter :: heavy(in_plane:in_space) = [1.0e2_wp, 1.0e4_wp]
   real(wp), parameter :: growth = 10.0_wp       !! factor on the weights in the plane where impulses have far to go
   integer, parameter :: patience = 15           !! rounds before that
   integer, parameter :: most_growth = 2         !! times
   integer, parameter :: creeping = 4            !! rounds in space before c is taken to where the last ones point
   integer, parameter :: most_newton = 60
   integer, parameter :: now = 1, before = 2     !! round
   integer, parameter :: most_tries = 30
   real(wp), parameter :: close = 0.01_wp        !! of the violation that is let pass: to that Newton's method goes on
   !> What a point does. A cone in the plane has two edges; on the round one in space that is one state. Points with strength
   !> may also open at the limit T: without slip (tears), or on the edge of both limits (shears)
   integer, parameter :: parts = 0, sticks = 1, slides = 2, slides_back = 3, tears = 4, shears = 5

   type :: impulse_problem
      integer :: directions = 0                     !! in_plane or in_space
      integer :: freedoms = 0                       !! of a body: 3 or 6
      integer :: nodes = 0                          !! bodies that move
      integer :: points = 0
      real(wp) :: heavy = 0.0_wp                    !! weights over the mass that a point feels
      real(wp), allocatable :: mass(:)              !! (freedoms nodes) by rank: of each freedom, mass or inertia
      real(wp), allocatable :: free(:)              !! (freedoms nodes) velocities without contacts
      real(wp), allocatable :: rate(:)              !! (freedoms nodes) velocities: a guess in, the answer out
      integer, allocatable :: node(:, :)            !! (2, points) ranks of both bodies, 0 where one is prescribed
      real(wp), allocatable :: row(:, :, :, :)      !! (freedoms, side, direction, points): w = sum of row.v + shift
      real(wp), allocatable :: shift(:, :)          !! (direction, points) [m/s]
      real(wp), allocatable :: friction(:)          !! (points) coefficient
      real(wp), allocatable :: cohesion(:)          !! (points) C [N s]; 0 unless set
      real(wp), allocatable :: tension(:)           !! (points) T [N s]; 0 unless set
      real(wp), allocatable :: impulse(:, :)        !! (direction, points): a guess in, the answer out [N s]
      real(wp), allocatable :: best(:, :)           !! (direction, points) impulses of the round of least violation
      type(skyline) :: matrix
      real(wp), allocatable :: weight(:)            !! (points) r
      real(wp), allocatable :: raised(:)            !! (points) c [m/s]
      real(wp), allocatable :: asked(:, :)          !! (points, now and before) c by the sliding found [m/s]
      real(wp), allocatable :: change(:, :)         !! (points, now and before) of c that this requires [m/s]
      real(wp), allocatable :: rate_at(:, :)        !! (direction, points) w [m/s]
      real(wp), allocatable :: trial(:, :)          !! (direction, points) p - r (w_n + c, w_t)
      real(wp), allocatable :: near(:, :)           !! (direction, points) the points of the cones nearest to these
      real(wp), allocatable :: try(:), load(:)      !! (freedoms nodes)
      real(wp), allocatable :: missing(:)           !! (freedoms nodes) [N s]
      real(wp), allocatable :: block(:, :)          !! ((2 freedoms)**2, pairs) what each pair adds to the matrix
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
   subroutine problem_new(nodes, directions, link, problem, status)
      integer, intent(in) :: nodes
      integer, intent(in) :: directions             !! in_plane or in_space
      integer, intent(in) :: link(:, :)             !! (2, links)
      type(impulse_problem), intent(out) :: problem
      integer(c_int), intent(out) :: status
      integer :: count, failed
      problem%nodes = nodes
      problem%directions = directions
      problem%freedoms = merge(3, 6, directions == in_plane)
      problem%heavy = heavy(directions)
      call skyline_new(nodes, problem%freedoms, link, problem%matrix, status)
      if (status /= status_ok) return
      count = problem%freedoms * nodes
      allocate (problem%mass(count), problem%free(count), problem%rate(count), problem%try(count), &
         problem%load(count), problem%missing(count), stat=failed)
      if (failed /= 0) status = status_out_of_memory
   end subroutine problem_new

   !> Room for `points` contact points of `pairs` pairs, instead of what there was
   subroutine problem_room(problem, points, pairs, status)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: points
      integer, intent(in) :: pairs
      integer(c_int), intent(out) :: status
      integer :: failed
      if (allocated(problem%node)) deallocate (problem%node, problem%row, problem%shift, problem%friction, &
         problem%cohesion, problem%tension, problem%impulse, problem%best, problem%weight, problem%raised, &
         problem%asked, problem%change, problem%rate_at, problem%trial, problem%near, problem%block, problem%state, problem%was)
      allocate (problem%node(2, points), problem%row(problem%freedoms, 2, problem%directions, points), &
         problem%shift(problem%directions, points), problem%friction(points), problem%cohesion(points), &
         problem%tension(points), &
         problem%impulse(problem%directions, points), problem%best(problem%directions, points), &
         problem%weight(points), problem%raised(points), problem%asked(points, 2), problem%change(points, 2), &
         problem%rate_at(problem%directions, points), problem%trial(problem%directions, points), &
         problem%near(problem%directions, points), problem%block((2 * problem%freedoms)**2, pairs), &
         problem%state(points), problem%was(points), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      problem%cohesion(:) = 0.0_wp
      problem%tension(:) = 0.0_wp
   end subroutine problem_room

   !> Impulses and velocities
   pure subroutine solve_impulses(problem, tolerance, most_rounds, effort)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! violation that is let pass [m/s]
      integer, intent(in) :: most_rounds
      type(impulse_effort), intent(out) :: effort
      real(wp) :: residual
      logical :: exact
      integer :: k, n

      n = problem%points
      call weigh_points(problem)
      problem%was(:n) = -1
      problem%raised(:n) = 0.0_wp
      call measure_rates(problem, problem%rate)
      do k = 1, n
         problem%raised(k) = raising(problem%friction(k), problem%rate_at(along_tangent:, k))
      end do
      do while (effort%rounds < most_rounds)
         effort%rounds = effort%rounds + 1
         call least_energy(problem, tolerance, effort, exact)
         call take_impulses(problem, exact, residual)
         if (effort%rounds == 1 .or. residual < effort%residual) then
            effort%residual = residual
            problem%best(:, :n) = problem%impulse(:, :n)
         end if
         call follow_states(problem, effort%rounds)
         effort%converged = effort%residual <= tolerance
         if (effort%converged) exit
         if (problem%directions == in_space) cycle
         if (mod(effort%rounds, patience) > 0 .or. effort%rounds > patience * most_growth) cycle
         problem%weight(:n) = growth * problem%weight(:n)
         problem%was(:n) = -1
      end do
      problem%impulse(:, :n) = problem%best(:, :n)
      ! The velocities that follow from these impulses alone
      problem%near(:, :n) = problem%best(:, :n)
      problem%missing(:) = problem%mass * problem%free
      call give_impulses(problem)
      problem%rate(:) = problem%missing / problem%mass
   end subroutine solve_impulses

   !> Weights: many times the mass that a point feels
   pure subroutine weigh_points(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k, d, side, at
      real(wp) :: lightness(in_space)
      do k = 1, problem%points
         lightness = 0.0_wp
         do d = 1, problem%directions
            do side = 1, 2
               if (problem%node(side, k) == 0) cycle
               at = problem%freedoms * (problem%node(side, k) - 1)
               lightness(d) = lightness(d) &
                  + sum(problem%row(:, side, d, k)**2 / problem%mass(at + 1:at + problem%freedoms))
            end do
         end do
         problem%weight(k) = problem%heavy / maxval(lightness)
      end do
   end subroutine weigh_points

   !> Whether a point is of other bodies than the one before it: points of one pair lie together
   pure function is_next_pair(problem, k) result(is_next)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k                      !! point
      logical :: is_next
      is_next = k == 1
      if (.not. is_next) is_next = any(problem%node(:, k) /= problem%node(:, k - 1))
   end function is_next_pair

   !> Velocities at the points, trial impulses and the points of the cones nearest to them, and what the points do, at
   !> some velocities of the bodies
   pure subroutine measure_rates(problem, rate)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: rate(:)
      real(wp) :: both(12)
      integer :: k, n, side, at

      n = problem%freedoms
      do k = 1, problem%points
         if (is_next_pair(problem, k)) then
            both = 0.0_wp
            do side = 1, 2
               at = n * (problem%node(side, k) - 1)
               if (at >= 0) both(n * (side - 1) + 1:n * side) = rate(at + 1:at + n)
            end do
         end if
         associate (row => problem%row(:, :, :, k), shift => problem%shift(:, k), w => problem%rate_at(:, k), &
                    weight => problem%weight(k), raised => problem%raised(k), impulse => problem%impulse(:, k), &
                    trial => problem%trial(:, k), near => problem%near(:, k), state => problem%state(k))
            ! Constant sizes let the compiler unroll the loops.
            if (problem%directions == in_plane) then
               call try_impulse(6, 2, row, both, shift, weight, raised, impulse, w, trial)
               call project_on_cone(2, problem%friction(k), problem%cohesion(k), problem%tension(k), trial, state, near)
            else
               call try_impulse(12, 3, row, both, shift, weight, raised, impulse, w, trial)
               call project_on_cone(3, problem%friction(k), problem%cohesion(k), problem%tension(k), trial, state, near)
            end if
         end associate
      end do
   end subroutine measure_rates

   !> Velocities at a point, and its trial impulse
   pure subroutine try_impulse(n, m, row, both, shift, weight, raised, impulse, w, trial)
      integer, value :: n                           !! freedoms of both bodies
      integer, value :: m                           !! directions
      real(wp), intent(in) :: row(n, m)
      real(wp), intent(in) :: both(n)               !! velocities of both bodies
      real(wp), intent(in) :: shift(m)
      real(wp), intent(in) :: weight
      real(wp), intent(in) :: raised
      real(wp), intent(in) :: impulse(m)
      real(wp), intent(out) :: w(m)
      real(wp), intent(out) :: trial(m)
      integer :: d, i
      do d = 1, m
         w(d) = shift(d)
         do i = 1, n
            w(d) = w(d) + row(i, d) * both(i)
         end do
         trial(d) = impulse(d) - weight * w(d)
      end do
      trial(along_normal) = trial(along_normal) - weight * raised
   end subroutine try_impulse

   !> Length of what a point slides by, or of the impulse that opposes it
   pure function length(along) result(l)
      real(wp), intent(in) :: along(:)              !! (1) in the plane, (2) in space
      real(wp) :: l
      if (size(along) > 1) then
         l = sqrt(along(1)**2 + along(2)**2)        ! hypot guards against overflow, at several times the cost
      else
         l = abs(along(1))
      end if
   end function length

   !> The admissible impulse nearest to a trial one: itself where it is admissible, else a point of the edge of the cone, of the
   !> limit of tension, or of both. Without strength the last is the apex of the cone
   pure subroutine project_on_cone(m, friction, cohesion, tension, trial, state, near)
      integer, value :: m                           !! directions
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: cohesion              !! C [N s]
      real(wp), intent(in) :: tension               !! T [N s], at most C / friction
      real(wp), intent(in) :: trial(m)
      integer, intent(out) :: state
      real(wp), intent(out) :: near(m)
      real(wp) :: across, push, held
      across = length(trial(along_tangent:))
      if (trial(along_normal) >= -tension .and. across <= cohesion + friction * trial(along_normal)) then
         state = sticks
         near = trial
         return
      end if
      push = (trial(along_normal) + friction * (across - cohesion)) / (1.0_wp + friction**2)
      if (push > -tension) then
         state = slides
         if (m == in_plane .and. trial(along_tangent) < 0.0_wp) state = slides_back
         near(along_normal) = push
         near(along_tangent:) = ((cohesion + friction * push) / across) * trial(along_tangent:)
         return
      end if
      held = 0.0_wp
      if (cohesion > 0.0_wp) held = max(0.0_wp, cohesion - friction * tension)
      near(along_normal) = -tension
      if (.not. held > 0.0_wp) then
         state = parts
         near(along_tangent:) = 0.0_wp
      else if (across <= held) then
         state = tears
         near(along_tangent:) = trial(along_tangent:)
      else
         state = shears
         near(along_tangent:) = (held / across) * trial(along_tangent:)
      end if
   end subroutine project_on_cone

   !> c: by how much the parting velocity is raised where a point slides
   pure function raising(friction, sliding) result(c)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: sliding(:)            !! [m/s]
      real(wp) :: c
      c = 0.0_wp
      if (friction < no_sliding) c = friction * length(sliding)
   end function raising

   !> Newton's method for the velocities at which that function is least. Minus its slope are the impulses that are
   !> still missing
   pure subroutine least_energy(problem, tolerance, effort, exact)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! [m/s]
      type(impulse_effort), intent(inout) :: effort
      logical, intent(out) :: exact                 !! nothing is missing but what rounding leaves
      integer :: n, round
      logical :: whole
      integer(c_int) :: status

      exact = .false.
      n = problem%points
      call measure_rates(problem, problem%rate)
      call find_missing(problem, problem%rate)
      do round = 1, most_newton
         if (.not. unchanged(problem)) then
            call assemble_matrix(problem)
            call skyline_factor(problem%matrix, status)
            problem%was(:n) = problem%state(:n)
            effort%factors = effort%factors + 1
            if (status /= status_ok) problem%was(:n) = -1
            if (status /= status_ok) return          ! what is missing counts as violation, and no number spreads
         end if
         problem%load(:) = problem%missing
         call skyline_solve(problem%matrix, problem%load)
         call go_along(problem, whole)
         if (.not. whole) cycle
         exact = unchanged(problem)
         if (exact) return
         ! Points on the verge of sliding may change sides without end and move nothing. And no velocity is farther off
         ! than by the impulses that are missing: what slides on a round cone has turned little.
         if (maxval(abs(problem%load)) < close * tolerance) return
         if (maxval(abs(problem%missing / problem%mass)) < close * tolerance) return
      end do
   end subroutine least_energy

   !> From the velocities along the step of Newton's method to where the slope of the function, which is convex, is a
   !> small share of that at the start
   pure subroutine go_along(problem, whole)
      type(impulse_problem), intent(inout) :: problem
      logical, intent(out) :: whole                 !! to the end of the step
      real(wp), parameter :: flat = 0.1_wp          !! of the slope at the start
      real(wp) :: slope, slope_low, slope_high, low, high, t
      integer :: tries

      low = 0.0_wp
      high = 1.0_wp
      t = 1.0_wp
      slope_low = -dot_product(problem%missing, problem%load)
      slope_high = 0.0_wp
      associate (enough => -flat * slope_low)
         do tries = 0, most_tries
            problem%try(:) = problem%rate + t * problem%load
            call measure_rates(problem, problem%try)
            call find_missing(problem, problem%try)
            slope = -dot_product(problem%missing, problem%load)
            whole = tries == 0
            if (.not. slope > enough .and. (whole .or. slope > -enough)) exit
            if (slope > 0.0_wp) then
               high = t
               slope_high = slope
            else
               low = t
               slope_low = slope
            end if
            ! Secant step, kept away from both ends
            t = slope_high / (slope_high - slope_low)
            t = high - min(0.9_wp, max(0.1_wp, t)) * (high - low)
         end do
      end associate
      problem%rate(:) = problem%try
   end subroutine go_along

   !> The impulses that are missing at velocities that have been looked at: minus the slope of the function
   pure subroutine find_missing(problem, rate)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: rate(:)
      problem%missing(:) = problem%mass * (problem%free - rate)
      call give_impulses(problem)
   end subroutine find_missing

   !> Whether the matrix is that of what the points do now: where one slides on a round cone it changes all the time
   pure function unchanged(problem) result(same)
      type(impulse_problem), intent(in) :: problem
      logical :: same
      associate (state => problem%state(:problem%points), was => problem%was(:problem%points))
         same = .not. any(state /= was)
         if (same .and. problem%directions == in_space) same = .not. any(state == slides .or. state == shears)
      end associate
   end function unchanged

   !> M + sum of r row row' over the directions in which points resist
   pure subroutine assemble_matrix(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: i, k, first, pair
      problem%matrix%a(:) = 0.0_wp
      do i = 1, problem%matrix%n
         problem%matrix%a(problem%matrix%start(i) + i) = problem%mass(i)
      end do
      first = 1
      pair = 0
      do k = 1, problem%points
         if (k < problem%points) then
            if (.not. is_next_pair(problem, k + 1)) cycle
         end if
         pair = pair + 1
         call assemble_pair(problem, first, k, pair)
         call skyline_add(problem%matrix, problem%node(:, k), problem%block(:, pair))
         first = k + 1
      end do
   end subroutine assemble_matrix

   !> Forces with which the points of a pair resist, unless they are those of the last call
   pure subroutine assemble_pair(problem, first, last, pair)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: first                  !! points
      integer, intent(in) :: last
      integer, intent(in) :: pair
      integer :: k
      logical :: same
      same = .true.
      do k = first, last
         same = same .and. problem%state(k) == problem%was(k)
         if (problem%directions == in_space) same = same .and. problem%state(k) /= slides &
            .and. problem%state(k) /= shears
      end do
      if (same) return
      problem%block(:, pair) = 0.0_wp
      do k = first, last
         if (problem%state(k) == parts) cycle
         if (problem%directions == in_plane) then
            call add_resistance(6, 2, problem%state(k), problem%friction(k), problem%weight(k), problem%trial(:, k), &
               problem%near(:, k), problem%row(:, :, :, k), problem%block(:, pair))
         else
            call add_resistance(12, 3, problem%state(k), problem%friction(k), problem%weight(k), problem%trial(:, k), &
               problem%near(:, k), problem%row(:, :, :, k), problem%block(:, pair))
         end if
      end do
   end subroutine assemble_pair

   !> Add to a block what a point resists with, in velocities of both bodies
   pure subroutine add_resistance(n, m, state, friction, weight, trial, near, row, block)
      integer, value :: n                           !! freedoms of both
      integer, value :: m                           !! directions
      integer, intent(in) :: state
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: weight
      real(wp), intent(in) :: trial(m)
      real(wp), intent(in) :: near(m)               !! the admissible impulse nearest to the trial one
      real(wp), intent(in) :: row(n, m)
      real(wp), intent(inout) :: block(n, n)
      real(wp) :: way(12)                           ! of changing size the compiler would take it from the heap
      real(wp) :: edge(3), turning, root, across
      if (state == sticks) then
         if (m == in_plane) then
            call add_outer(n, 2, [weight, weight], row, block)
         else
            call add_outer(n, 3, [weight, weight, weight], row, block)
         end if
         return
      end if
      if (state == tears .and. m == in_plane) call add_outer(n, 1, [weight], row(:, 2:2), block)
      if (state == tears .and. m == in_space) call add_outer(n, 2, [weight, weight], row(:, 2:m), block)
      if (state == tears) return
      ! As far as the impulse turns with the trial impulse, at a right angle to it; and on the edge of the cone
      across = length(trial(along_tangent:))
      if (m == in_space) then
         turning = length(near(along_tangent:)) / across
         way(:n) = (trial(2) * row(:, m) - trial(m) * row(:, 2)) / across
         call add_outer(n, 1, [turning * weight], way, block)
      end if
      if (state == shears) return
      root = sqrt(1.0_wp + friction**2)
      edge(along_normal) = 1.0_wp / root
      edge(along_tangent:m) = (friction / (root * across)) * trial(along_tangent:)
      way(:n) = edge(1) * row(:, 1) + edge(2) * row(:, 2)
      if (m == in_space) way(:n) = way(:n) + edge(m) * row(:, m)
      call add_outer(n, 1, [weight], way, block)
   end subroutine add_resistance

   !> Add the sum of weight * row * row' to a block
   pure subroutine add_outer(n, m, weight, row, block)
      integer, value :: n
      integer, value :: m
      real(wp), intent(in) :: weight(m)
      real(wp), intent(in) :: row(n, m)
      real(wp), intent(inout) :: block(n, n)
      integer :: i, j, d
      real(wp) :: factor(m), total
      do j = 1, n
         factor = weight * row(j, :)
         do i = 1, n
            total = block(i, j)
            do d = 1, m
               total = total + factor(d) * row(i, d)
            end do
            block(i, j) = total
         end do
      end do
   end subroutine add_outer

   !> Add the impulses that were found at the points to what is missing [N s]
   pure subroutine give_impulses(problem)
      type(impulse_problem), intent(inout) :: problem
      real(wp) :: both(12)
      integer :: k, n, side, at
      n = problem%freedoms
      both = 0.0_wp
      do k = 1, problem%points
         if (problem%directions == in_plane) then
            call add_momentum(6, 2, problem%row(:, :, :, k), problem%near(:, k), both)
         else
            call add_momentum(12, 3, problem%row(:, :, :, k), problem%near(:, k), both)
         end if
         if (k < problem%points) then
            if (.not. is_next_pair(problem, k + 1)) cycle
         end if
         do side = 1, 2
            at = n * (problem%node(side, k) - 1)
            if (at >= 0) problem%missing(at + 1:at + n) = problem%missing(at + 1:at + n) &
               + both(n * (side - 1) + 1:n * side)
         end do
         both = 0.0_wp
      end do
   end subroutine give_impulses

   !> Momenta of both bodies by an impulse at a point
   pure subroutine add_momentum(n, m, row, impulse, both)
      integer, value :: n
      integer, value :: m
      real(wp), intent(in) :: row(n, m)
      real(wp), intent(in) :: impulse(m)
      real(wp), intent(inout) :: both(n)
      integer :: d
      do d = 1, m
         both = both + impulse(d) * row(:, d)
      end do
   end subroutine add_momentum

   !> New impulses from the trial ones, and by how much the law was violated, at the velocities that follow from the
   !> impulses: Newton's method may have left some of these missing
   pure subroutine take_impulses(problem, exact, residual)
      type(impulse_problem), intent(inout) :: problem
      logical, intent(in) :: exact                  !! see least_energy
      real(wp), intent(out) :: residual             !! [m/s]
      real(wp) :: raised, rounding
      integer :: k
      residual = 0.0_wp
      ! Of r w over the mass, as what is missing is a difference of such
      rounding = 10.0_wp * problem%heavy * epsilon(1.0_wp) * maxval(abs(problem%rate))
      do k = 1, problem%points
         raised = raising(problem%friction(k), problem%rate_at(along_tangent:, k))
         residual = max(residual, maxval(abs(problem%near(:, k) - problem%impulse(:, k))) / problem%weight(k))
         if (.not. exact) residual = max(residual, not_reached(problem, k) - rounding)
         if (problem%state(k) == parts .or. problem%state(k) >= tears) then
            residual = max(residual, -problem%rate_at(along_normal, k))
         else
            residual = max(residual, abs(raised - problem%raised(k)))
         end if
         problem%impulse(:, k) = problem%near(:, k)
         problem%asked(k, now) = raised
      end do
   end subroutine take_impulses

   !> By how much the velocities at a point change if the bodies are given what is missing [m/s]
   pure function not_reached(problem, k) result(change)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp) :: change
      real(wp) :: w
      integer :: d, i, side, at
      change = 0.0_wp
      do d = 1, problem%directions
         w = 0.0_wp
         do side = 1, 2
            at = problem%freedoms * (problem%node(side, k) - 1)
            if (at < 0) cycle
            do i = 1, problem%freedoms
               w = w + problem%row(i, side, d, k) * problem%missing(at + i) / problem%mass(at + i)
            end do
         end do
         change = max(change, abs(w))
      end do
   end function not_reached

   !> Velocities at a point that follow from the impulses found (normal, then tangents) [m/s]
   pure function find_point_rate(problem, k) result(w)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp) :: w(in_space)
      integer :: d, side, at
      w = 0.0_wp
      do d = 1, problem%directions
         w(d) = problem%shift(d, k)
         do side = 1, 2
            at = problem%freedoms * (problem%node(side, k) - 1)
            if (at < 0) cycle
            w(d) = w(d) + dot_product(problem%row(:, side, d, k), problem%rate(at + 1:at + problem%freedoms))
         end do
      end do
   end function find_point_rate

   !> c for the next round: as was found, and where that comes no nearer in space, as it would come to rest if
   !> every change were that share of the one before it that the last two show (Anderson 1965, of one round). In the
   !> plane, where what slides cannot turn, more steps converge so, but the others miss by more
   pure subroutine follow_states(problem, rounds)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: rounds                 !! so far
      real(wp), parameter :: farthest = 100.0_wp    !! changes at once
      real(wp) :: back, square, share
      logical :: far
      integer :: k
      far = problem%directions == in_space .and. rounds > creeping
      back = 0.0_wp
      square = 0.0_wp
      do k = 1, problem%points
         problem%change(k, now) = problem%asked(k, now) - problem%raised(k)
         if (.not. far) cycle
         back = back + problem%change(k, now) * (problem%change(k, now) - problem%change(k, before))
         square = square + (problem%change(k, now) - problem%change(k, before))**2
      end do
      share = 0.0_wp
      if (square > 0.0_wp) share = max(-farthest, min(farthest, back / square))
      do k = 1, problem%points
         problem%raised(k) = problem%asked(k, now)
         if (abs(share) > 0.0_wp) problem%raised(k) = max(0.0_wp, &
            problem%asked(k, now) - share * (problem%asked(k, now) - problem%asked(k, before)))
      end do
      problem%asked(:problem%points, before) = problem%asked(:problem%points, now)
      problem%change(:problem%points, before) = problem%change(:problem%points, now)
   end subroutine follow_states

end module nonsmooth_impulses
